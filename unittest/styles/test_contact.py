"""Range of contact between bodies (keyword contact of the solid pair styles): forces, stiffness,
and the friction that a lattice makes."""

import numpy as np
import pytest
from decks import deck
from scenes import RUBBER, Scene, close, lattice, pairs, run, sum_over

DX, RHO, E, NU = 0.1, 1000.0, 1e5, 0.3
K = E / (3 * (1 - 2 * NU))
MATERIAL = f"solid rho {RHO} young {E} poisson {NU}"
STYLES = pytest.mark.parametrize("style", ["fsi/solid", "fsi/solid/tl"])
RANGES = pytest.mark.parametrize("reach", [1.0, 1.4, 2.0, 2.5])
DIMS = pytest.mark.parametrize("dim", [2, 3])


def two_blocks(n, gap, shift=0.0):
    """Two blocks of a lattice, the second `gap` above the first one's last layer and shifted along
    x: positions, bodies."""
    dim = len(n)
    x = lattice(n, DX)
    up = np.zeros(3)
    up[0], up[dim - 1] = shift, (n[-1] - 1) * DX + gap
    return np.vstack([x, x + up]), np.repeat([1, 2], len(x))


def forces(style, x, mol, reach, dim):
    with Scene(x, dim=dim, dx=DX, mol=mol, materials=(MATERIAL,), solid_style=style,
               solid=f"contact {reach}") as s:
        return s.run().get("f")


@STYLES
@RANGES
@DIMS
def test_force_of_pairs(style, reach, dim):
    """Against numpy: the derivative of s K dx^D/2 (1 - r/R dx)^2 summed over pairs of different
    bodies; s by central differences of the same sum over facing half spaces, which must push back
    like the bulk where they are dx apart."""
    def energy(gap):    # per particle of the face, over s K; lattice of unit spacing
        m = np.arange(-4, 5)
        side = np.stack(np.meshgrid(*[m] * (dim - 1)), -1).reshape(-1, dim - 1)
        return sum(n * np.maximum(1 - np.hypot(np.linalg.norm(side, axis=1), gap + n - 1) / reach,
                                  0)**2 for n in range(1, 5)).sum() / 2

    # below 1, where the pairs at a distance of exactly R take part, too
    step, at = 1e-4, 1 - 2e-4
    s = 1 / ((energy(at + step) - 2 * energy(at) + energy(at - step)) / step**2)
    x, mol = two_blocks([7] + [5] * (dim - 1), 0.83 * DX, 0.31 * DX)
    i, j, d, r = pairs(x, reach * DX)
    apart = mol[i] != mol[j]
    f = s * K * DX**dim / (reach * DX) * np.maximum(1 - r / (reach * DX), 0) * apart
    expected = sum_over(i, (f / r)[:, None] * d, len(x))
    # the second derivative at 1 - 2e-4 instead of at 1
    close(forces(style, x, mol, reach, dim), expected, 2e-3)


def friction(reach, load):
    """Largest ratio of tangential to normal force while one rigid square lattice slides over an
    equal, aligned one under a constant load, a pressure over K: an upper bound, since all particles
    of the face climb at once."""
    def pull(gap, shift):    # on one particle of the face and those above it
        layer, column = np.meshgrid(np.arange(1, 5), np.arange(-6, 7), indexing="ij")
        d = np.stack([shift + column, gap + layer - 1.0])
        r = np.hypot(*d)
        return (layer * np.maximum(1 - r / reach, 0) * d / r).sum((1, 2))

    stiffness = 1.0 if reach == 1.0 else (pull(0.999, 0.0)[1] - pull(1.0, 0.0)[1]) / 0.001
    worst = 0.0
    for shift in np.linspace(0, 0.5, 26):
        low, high = 0.3, reach
        for _ in range(60):
            gap = 0.5 * (low + high)
            low, high = (gap, high) if pull(gap, shift)[1] > load * stiffness else (low, gap)
        tangential, normal = pull(gap, shift)
        worst = max(worst, abs(tangential / normal))
    return worst


def test_friction_of_lattices():
    """Of rigid ones. At vanishing load only the nearest particles touch, balls of radius R/2 on a
    row of such balls dx apart: tan asin 1/2R."""
    for reach in (1.0, 1.5, 2.0, 2.5):
        light, heavy = friction(reach, 1e-5), friction(reach, 0.05)
        print(f"friction of rigid lattices, contact {reach}: {light:.3f} at no load, {heavy:.3f} "
              "at 5 % of K")
        # the shifts are 0.02 apart, so that the steepest point, at 1/2, is met
        assert light == pytest.approx(np.tan(np.arcsin(0.5 / reach)), rel=0.06)
        assert heavy < light


def sliding(reach, speed=0.2, time=0.6):
    """A rubber block slides over held rubber under its weight (g = 1, without damping): mean
    deceleration over g, which would be the coefficient of friction."""
    floor, block = lattice([40, 4], DX), lattice([10, 5], DX)
    x = np.vstack([floor, block + [0.5 + 0.37 * DX, 0.4 + (reach - 1.0) * DX, 0]])
    mol = np.repeat([1, 2], [len(floor), len(block)])
    v = np.zeros_like(x)
    v[mol == 2, 0] = speed
    with Scene(x, v, dx=DX, mol=mol, materials=(MATERIAL,), solid_style="fsi/solid/tl",
               solid=f"contact {reach} artificial/visc 0.2 0",
               held=mol == 1, dt=1.5e-3, commands=("fix g all gravity 1.0 vector 0 -1 0",)) as s:
        s.run(round(time / 1.5e-3))
        left = s.get("v")[mol == 2, 0].mean()
    return (speed - left) / time


def test_sliding_block():
    """With contact 1 the block catches in the hollows of the lattice; with contact 2.5 it slides
    four times as freely."""
    caught, free = sliding(1.0), sliding(2.5)
    print(f"deceleration over g of a block on a floor: {caught:.3f} (contact 1), {free:.4f} "
          "(contact 2.5)")
    assert caught > 0.15 and free < 0.5 * caught


def test_bodies_apart_by_the_range_do_not_push():
    x, mol = two_blocks([6, 5], 2.5001 * DX)
    assert np.abs(forces("fsi/solid/tl", x, mol, 2.5, 2)).max() < 1e-9 * E * DX


@pytest.mark.parametrize("kernel, hdx", [("wendland", 1.5), ("cubic", 1.0), ("quintic", 1.0)])
def test_at_the_edge_of_the_support(kernel, hdx):
    """Bodies as far apart as the kernel reaches, less round-off, where its gradient vanishes, with
    contact as short and as long as it may be: forces, and those of viscosity, are finite and vanish
    with the distance that is left."""
    support = (3 if kernel == "quintic" else 2) * hdx
    for reach in (1.0, support):
        x, mol = two_blocks([6, 5], 0.0)
        size = {}
        for left in [k * 1e-16 for k in range(9)] + [1e-7, 1e-4]:
            y = x + (mol == 2)[:, None] * [0, support * DX * (1 - left), 0]
            v = np.where(mol == 2, -1.0, 0.0)[:, None] * [0, 1.0, 0]
            with Scene(y, v, dx=DX, kernel=kernel, hdx=hdx, mol=mol, materials=(MATERIAL,),
                       solid=f"contact {reach} artificial/visc 0.1 0.1") as s:
                size[left] = np.abs(s.run().get("f")).max()
        assert all(size[left] < 1e-9 * E * DX for left in size if left < 1e-9), size
        if reach > 1.0:
            assert size[1e-4] == pytest.approx(1e3 * size[1e-7], rel=0.01)


@STYLES
def test_range_is_kept_in_restart_files(style, tmp_path):
    x, mol = two_blocks([7, 5], 0.9 * DX, 0.2 * DX)
    with Scene(x, dx=DX, mol=mol, materials=(MATERIAL,), solid_style=style,
               solid="contact 2.2") as s:
        before = s.run().get("f")
        s.run_lines(f"write_restart {tmp_path / 'here'}", "clear",
                    f"read_restart {tmp_path / 'here'}", f"fix sph all fsi {DX} wendland 1.5",
                    "fix stress all fsi/stress" if style == "fsi/solid" else "")
        close(s.run().get("f"), before, 1e-12)


@pytest.mark.parametrize("reach, ranks", [("", 1), ("", 2), ("contact 2.5", 1)])
def test_first_touch_of_bumpy_faces_is_told(tmp_path, reach, ranks):
    """Once, and not at the start: a block falls onto a floor that is held, beside another block of
    the floor that it touches from the start."""
    text = deck("-0.1 0.3 -0.1 0.3", 0.01, {"rubber": RUBBER}, "fix 2 block gravity 9.81 vector 0 -1 0", "fix 3 all fsi/dt 1", "run {}", made="""
region floor block -0.05 0.2 -0.04 0 INF INF units box
create_atoms 1 region floor
region left block INF 0 INF 0 INF INF units box
set group all mol 3
set group block mol 1
set region left mol 2""", group="block", solid=f"artificial/visc 0.1 0 {reach}", skin=0.6, block="0 0.1 0.03 0.08")
    found = lambda steps: [line
                           for line in run(tmp_path, text.format(steps), ranks).output.splitlines()
                           if "touch. With contact" in line]
    assert found(20) == []
    assert [line[:61] for line in found(400)] == (
        [] if reach else ["WARNING: Pair style fsi/solid/tl: bodies 1 and 3 touch. With "])
