"""Contact of a body with itself (keyword self): forces and energy, who takes part, momentum, ranks,
restarts, torn pieces, both forms of solids."""

import re

import numpy as np
import pytest
import decks
from scenes import RUBBER, Scene, close, lammps, lattice, pairs, run, sum_over

DX, RHO, E, NU = 0.1, 1000.0, 1e5, 0.3
K = E / (3 * (1 - 2 * NU))
MATERIAL = f"solid rho {RHO} young {E} poisson {NU}"
SUPPORT = 3.0  # of Wendland's kernel with h = 1.5 dx, in spacings
STYLES = pytest.mark.parametrize("style", ["fsi/solid", "fsi/solid/tl"])
DIMS = pytest.mark.parametrize("dim", [2, 3])


def horseshoe(dim, gap=8):
    """Two arms, 12 long and 3 thick, `gap` spacings apart, joined at their left ends; 3 deep in 3D:
    (positions, which are of the upper arm)."""
    n = [12, 6 + gap] + [3] * (dim - 2)
    x = lattice(n, DX)
    column, row = np.round(x[:, :2] / DX - 0.5).astype(int).T
    kept = (column < 3) | (row < 3) | (row >= 3 + gap)
    return x[kept], (row >= 3 + gap)[kept] & (column[kept] >= 3)


def law(x, X, mol, reach, dim, support=SUPPORT):
    """Forces and energy of pairs of one body that are no neighbors in the reference, X: s K dx^D/2
    (1 - r/R dx)^2 with R dx replaced in the bracket's range by half of their distance there, if
    that is less (of no effect beyond twice the range). s as in test_contact.py: the sum over facing
    half spaces."""
    def energy(gap):
        m = np.arange(-4, 5)
        side = np.stack(np.meshgrid(*[m] * (dim - 1)), -1).reshape(-1, dim - 1)
        return sum(n * np.maximum(1 - np.hypot(np.linalg.norm(side, axis=1), gap + n - 1) / reach,
                                  0)**2 for n in range(1, 5)).sum() / 2

    step, at = 1e-4, 1 - 2e-4
    s = 1 / ((energy(at + step) - 2 * energy(at) + energy(at - step)) / step**2)
    i, j, d, r = pairs(x, reach * DX)
    far = np.linalg.norm(X[i] - X[j], axis=1)
    to = np.minimum(reach * DX, 0.5 * far)
    part = (mol[i] == mol[j]) & (far >= support * DX * (1 - 1e-9)) & (r < to)
    k = s * K * DX**(dim - 2) / reach**2
    f = k * np.maximum(to - r, 0) * part
    return sum_over(i, (f / r)[:, None] * d, len(x)), 0.25 * (k * np.maximum(to - r, 0)**2
                                                              * part).sum()


@DIMS
def test_forces_of_the_updated_form(dim):
    """Against numpy: pairs further apart than two supports at the start only push; everything else
    is without stress in this state."""
    X, upper = horseshoe(dim)
    x = X + upper[:, None] * [0.2 * DX, (0.8 - 9) * DX, 0]
    with Scene(X, dim=dim, dx=DX, materials=(MATERIAL,), solid_style="fsi/solid",
               solid="contact 2 self yes") as s:
        s.run()
        s.put("x", x)
        f = s.run().get("f")
        expected = law(x, X, s.get("molecule"), 2.0, dim, 2 * SUPPORT)[0]
    assert np.abs(expected).max() > 0
    close(f, expected, 2e-3)


def folded(dim, gap, keywords, more="", **options):
    """Forces, strain energy and reference of a horseshoe whose upper arm is where its lowest row is
    `gap` above the lower arm's highest."""
    X, upper = horseshoe(dim)
    x = X + upper[:, None] * [0.2 * DX, (gap / DX - 9) * DX, 0]
    with Scene(X, dim=dim, dx=DX, materials=(MATERIAL,), solid_style="fsi/solid/tl",
               solid=f"hourglass 0.05 {keywords}", commands=("compute e all fsi/energy", more),
               **options) as s:
        s.run()
        s.put("x", x)
        f = s.run().get("f")
        return f, s.ledger()[3], X, x, s.get("molecule")


@DIMS
@pytest.mark.parametrize("reach", [1.0, 2.0, 2.5])
def test_forces_and_energy(dim, reach):
    """Against numpy: what self adds to forces and energy of the same state. The stiffness's second
    derivative is taken at 1 - 2e-4 instead of at 1."""
    with_self, without = (folded(dim, 0.8 * DX, f"contact {reach} self {word}")
                          for word in ("yes", "no"))
    f, energy = law(with_self[3], with_self[2], with_self[4], reach, dim)
    assert np.abs(f).max() > 0
    # the strain of the joint, torn by three spacings, is of no concern: its forces are the same bit
    # for bit but for the sum's last digits
    close(with_self[0] - without[0], f, 2e-3)
    assert with_self[1] - without[1] == pytest.approx(energy, rel=2e-3)
    # round-off
    assert np.abs(with_self[0].sum(0)).max() < 1e-12 * np.abs(with_self[0]).max() * len(f)


@pytest.mark.parametrize("kernel, hdx, reach", [("wendland", 1.5, 3.0), ("wendland", 1.5, 2.0),
                                                ("cubic", 1.0, 2.0), ("quintic", 1.0, 2.5)])
@STYLES
def test_a_body_at_rest_or_bent_has_none(style, kernel, hdx, reach):
    """A block, and one bent round a circle of three times its thickness, 17 % shorter inside:
    forces are the same with and without, to the last bit."""
    X = lattice([30, 6], DX)
    angle, radius = (X[:, 0] - 1.5) / 1.8, 1.8 + X[:, 1] - 0.3
    bent = np.stack([radius * np.sin(angle), radius * np.cos(angle), 0 * angle], axis=1)
    found = {}
    for word in ("yes", "no"):
        with Scene(X, dx=DX, kernel=kernel, hdx=hdx, materials=(MATERIAL,), solid_style=style,
                   solid=f"contact {reach} self {word}", box=((-4, -4, -1), (7, 5, 1))) as s:
            found[word] = [s.run().get("f")]
            s.put("x", bent)
            found[word].append(s.run().get("f"))
    assert np.abs(found["yes"][0] - found["no"][0]).max() == 0
    # sums of updated-Lagrangian pairs in another order
    assert np.abs(found["yes"][1] - found["no"][1]).max() <= 1e-13 * np.abs(found["no"][1]).max()


def clapping(style="fsi/solid/tl", dim=2, self_contact="yes", more=(), **options):
    """A horseshoe whose arms are thrown against each other."""
    x, upper = horseshoe(dim, 4 if style == "fsi/solid/tl" else 7)
    keep = "hourglass 0.05" if style == "fsi/solid/tl" else "gradient quadratic"
    v = np.zeros_like(x)
    arm, low = np.clip(x[:, 0] - 0.3, 0, None), x[:, 1] < 0.3
    v[upper, 1], v[low, 1] = -arm[upper], arm[low]
    return Scene(x, v, dim=dim, dx=DX, materials=(MATERIAL,), solid_style=style, dt=1e-3, skin=0.4,
                 solid=f"artificial/visc 0.05 0 contact 2 self {self_contact} {keep}",
                 commands=("compute e all fsi/energy", *more), **options), x, upper


def nearest(x, upper, X):
    low = (X[:, 1] < 3 * DX) & (X[:, 0] > 3 * DX)
    return np.linalg.norm(x[upper][:, None] - x[low][None], axis=2).min()


@DIMS
@STYLES
def test_arms_do_not_pass(style, dim):
    """The gap stays about the range of contact, 2 dx, less what the blow presses it together;
    energy and momentum are kept. Without self they pass."""
    gaps = {}
    for word in ("yes", "no"):
        scene, X, upper = clapping(style, dim, word)
        with scene as s:
            s.run()
            start, p0 = s.ledger().sum(), s.momentum()
            gap, worst = [], 0.0
            for _ in range(24):
                s.run(50)
                gap.append(nearest(s.get("x"), upper, X) / DX)
                worst = max(worst, abs(s.ledger().sum() - start) / start)
            gaps[word] = min(gap), gap[-1]
            scale = (s.get("rmass")[:, None] * np.abs(s.get("v"))).sum()
            assert np.abs(s.momentum() - p0).max() < 1e-11 * scale
            if word == "yes":
                # of second order in dt; those of the updated form are integrated in time
                assert worst < (0.005 if style == "fsi/solid/tl" else 0.05), worst
    print(f"{style}, {dim}D, nearest and at the end: {gaps['yes']} dx with self, {gaps['no']} "
          "without")
    assert gaps["yes"][0] > 1.2
    # in updated-Lagrangian form what is near is one material, which pushes, too
    if style == "fsi/solid/tl":
        assert gaps["no"][0] < 0.8


def deck(boundary="f f p", newton="on", processors="* * *", along=0, more="", sub="", dt=1e-3):
    """A hairpin whose legs meet."""
    return decks.deck("-0.5 2 -0.5 1.5", DX, {"rubber": RUBBER}, """compute e all fsi/energy
neigh_modify every 1 delay 0 check yes
thermo 50
thermo_style custom step c_e ke press""", boundary=boundary, before=[f"newton {newton}", f"processors {processors}"], root="0 0.3 0 1", made=f"""
region a block 0.3 1.2 0 0.3 INF INF units box
region b block 0.3 1.2 0.7 1 INF INF units box
create_atoms 1 region a
create_atoms 1 region b
set group all mol 1
reset_atoms id sort yes
variable v atom 3*(x-0.3)*(x>0.3)*((y<0.5)-(y>0.5))
velocity all set {along} v_v 0 units box""", solid=f"artificial/visc 0.05 0 contact 2 self yes {more}", sph=sub, dt=dt, skin=0.4)


LAST = "\nwrite_dump all custom end.dump id x y vx vy modify sort id format float %.17g\n"


def state(folder):
    return np.loadtxt(folder / "end.dump", skiprows=9)


@pytest.mark.parametrize("sub", ["", "substeps 5"])
def test_ranks_and_newton(tmp_path, sub):
    """To round-off, grown in a blow: 1, 2 and 4 ranks, newton on and off, drifting through a
    periodic box; energy and pressure, too."""
    found = {}
    for name, ranks, options in (("one", 1, {}), ("off", 1, {"newton": "off"}),
                                 ("two", 2, {"processors": "1 2 1"}),
                                 ("four", 4, {"processors": "2 2 1", "newton": "off"})):
        folder = tmp_path / name
        result = run(folder, deck(boundary="p p p", along=5, sub=sub, dt=5e-3 if sub else 1e-3,
                                  **options) + f"run {40 if sub else 200}" + LAST, ranks)
        thermo = np.array([line.split() for line in result.output.splitlines()
                           if re.match(r" +\d+ +[-\d.e+]+ +[-\d.e+]+ +[-\d.e+]+ *$", line)], float)
        found[name] = state(folder), thermo
    for name in ("off", "two", "four"):
        for k in (0, 1):
            close(found[name][k], found["one"][k], 1e-8)


@pytest.mark.parametrize("more", ["", "damage 0.15 gradient linear"])
def test_restart_goes_on_bit_for_bit(tmp_path, more):
    run(tmp_path / "whole", deck(more=more) + "restart 100 r.*\nrun 150" + LAST, 2)
    run(tmp_path / "on", f"read_restart {tmp_path / 'whole/r.100'}\nfsi/material"
        + deck(more=more).split("fsi/material")[1] + "run 50" + LAST, 2)
    np.testing.assert_array_equal(state(tmp_path / "on"), state(tmp_path / "whole"))


@pytest.mark.parametrize("skin", ["0.01", "0.2"])
def test_nothing_depends_on_lists(tmp_path, skin):
    """Two skins give what a third gives, to round-off that a blow lets grow, with bonds that
    break."""
    ends = []
    for name, width in (("other", skin), ("usual", "0.04")):
        run(tmp_path / name,
            deck(more="damage 0.15 gradient linear").replace("neighbor 0.04", f"neighbor {width}")
            + "run 150" + LAST)
        ends.append(state(tmp_path / name))
    close(*ends, 1e-8)


def test_torn_pieces_meet_again():
    """A strip is torn in two, the halves come back: without self they pass through each other, with
    self they rebound; breaking makes no energy."""
    X = lattice([16, 4], DX)
    right, column = X[:, 0] > 0.8, np.round(X[:, 0] / DX - 0.5).astype(int)
    gaps = {}
    for word in ("yes", "no"):
        with Scene(X, np.where(right, 4.0, -4.0)[:, None] * [1.0, 0, 0], dx=DX,
                   materials=(MATERIAL,), solid_style="fsi/solid/tl", dt=5e-4, skin=0.4,
                   solid=f"damage 0.2 gradient linear artificial/visc 0.1 0 contact 1 self {word}",
                   box=((-4, -1, -1), (6, 2, 1)), commands=("compute e all fsi/energy",)) as s:
            s.run()
            total = [s.ledger().sum()]
            for _ in range(8):
                s.run(25)
                total.append(s.ledger().sum())
            assert max(total) < 1.001 * total[0]  # breaking takes energy
            x = s.get("x")
            assert x[column == 8, 0].min() - x[column == 7, 0].max() > 3 * DX  # torn
            s.put("v", np.where(right, -2.0, 2.0)[:, None] * [1.0, 0, 0])
            s.run()
            total, gap = [s.ledger().sum()], []
            for _ in range(30):
                s.run(25)
                total.append(s.ledger().sum())
                x = s.get("x")
                gap.append((x[right, 0].mean() - x[~right, 0].mean()) / DX)
            gaps[word] = min(gap)
            assert max(total) < 1.005 * total[0]
    print(f"centers of the halves, 8 dx apart at first, come to {gaps['yes']:.1f} dx with self, "
          f"{gaps['no']:.1f} without")
    # waves of 11.6 m/s: halves stopped from 2 m/s are 17 % shorter, 6.6 dx apart, and a little more
    # where they are pressed
    assert gaps["yes"] > 5.5 and gaps["no"] < 2.0


def test_breaking_adds_no_energy():
    """A metal bar, torn and sheared: what loses so many bonds that no gradient is left has also
    compressed ones, on which contact acted at once: 2.1 J of 85 J in one step."""
    dx = 0.01
    x = lattice([20, 4], dx) - [10 * dx, 0, 0]
    v = np.zeros_like(x)
    v[:, 0], v[:, 1] = 80 * x[:, 0], 10 * x[:, 1] * (x[:, 0] > 0)
    with Scene(x, v, dx=dx, solid_style="fsi/solid/tl", dt=1e-5,
               materials=("solid rho 1000 young 1e6 poisson 0.3 yield 3e4 hardening 1e5",),
               solid="damage 0.1 gradient linear law hypo self yes", box=([-0.5] * 3, [0.5] * 3),
               commands=["compute e all fsi/energy", "fix stress all fsi/stress plastic",
                         "comm_modify cutoff 0.1"]) as s:
        s.run()
        sums = []
        for _ in range(1500):
            s.run(1)
            sums.append(s.ledger().sum())
        print(f"sum {sums[0]:.3f} to {sums[-1]:.3f} J, at most {np.diff(sums).max():.1e} J a step")
        assert sums[-1] < sums[0] - 1
        assert np.diff(sums).max() < 0.01


def test_parts_that_pass_are_named(tmp_path):
    """Once, with self off, in a scene of one body that has no list of solid pairs; not with self
    on, nor while nothing passes."""
    name = (r"WARNING: Pair style fsi/solid/tl: atoms (\d+) and (\d+) of body 1 have no bond and "
            r"are 0\.\d+ spacings apart at step \d+: .* contact 2 self yes")
    off = run(tmp_path / "off", deck().replace("self yes", "") + "run 500\nrun 300").output
    assert len(re.findall(name, off)) == 1
    for other in (deck() + "run 500", deck().replace("self yes", "").replace("velocity", "#")
                  + "run 500"):
        assert "pass through" not in run(tmp_path / "other", other).output


def test_self_must_be_on_when_the_reference_is_taken(tmp_path):
    """In the sub-style that keeps its reference over runs: read from a restart file without
    positions."""
    run(tmp_path, deck().replace("self yes", "") + "run 1\nwrite_restart r.off")
    text = ("read_restart r.off\nfsi/material rubber solid rho 1000 young 1e5 poisson 0.3\n"
            "pair_style fsi/solid/tl contact 2 self yes\npair_coeff * * NULL rubber\n"
            "fix sph all fsi 0.1 wendland 1.5\ntimestep 1e-3\nrun 1\n")
    done = lammps(tmp_path, text)
    assert done.status != 0 and re.search(
        "self yes requires bodies that had it from their first run on", done.errors[0])
