"""Law viscoelastic: relaxation, damped waves and swings against closed forms, energy, restart, bad
input."""

import numpy as np
import pytest
from decks import box, materials
from scenes import RUBBER, Kernel, Scene, close, differing, lammps, lattice, run, watch

RHO, E, NU = 1000.0, 1.0e5, 0.3
G, K = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
DX = 0.1
TERMS = ((0.3, 0.02), (0.2, 0.2))  # g, tau
DIMS = pytest.mark.parametrize("dim", [2, 3])


def material(terms, nu=NU):
    return f"solid rho {RHO} young {E} poisson {nu}" + (" prony " if terms else "") + " ".join(
        f"{g} {tau}" for g, tau in terms)


def solid(x, v=None, terms=TERMS, keywords="", **more):
    return Scene(x, v, **{"dim": 3 if np.ptp(x[:, 2]) else 2, "dx": DX,
                          "materials": (material(terms),), "dt": 1e-3,
                          "solid": f"law viscoelastic {keywords}", "solid_style": "fsi/solid/tl",
                          **more})


def relaxation(t, terms=TERMS):
    """G(t)/G(0)"""
    return 1 - sum(g * (1 - np.exp(-t / tau)) for g, tau in terms)


def poles(modulus, stiffness, terms):
    """Roots s of mass s^2 + stiffness(G*(s)) = 0 by Newton's method from the elastic one; modulus:
    G(0); G* = s times the transform of G(t)."""
    def complex_modulus(s):
        return modulus * (1 - sum(g / (1 + s * tau) for g, tau in terms))

    def f(s):
        return s * s + stiffness(complex_modulus(s))

    s = 1j * np.sqrt(stiffness(modulus))
    for _ in range(50):
        d = 1e-6 * abs(s)
        s -= f(s) * 2 * d / (f(s + d) - f(s - d))
    assert abs(f(s)) < 1e-9 * abs(s)**2
    return s


def damped_swing(a, dt, order=3):
    """The root s of the largest part exp(st) that swings, in samples of a sum of so many
    exponentials: they obey a recurrence (Prony's method)."""
    rows = np.column_stack([a[order - 1 - k:len(a) - 1 - k] for k in range(order)])
    z = np.roots([1, *-np.linalg.lstsq(rows, a[order:], rcond=1e-10)[0]])
    amplitudes = np.linalg.lstsq(z[None] ** np.arange(len(a))[:, None], a + 0j, rcond=None)[0]
    return np.log(z[np.argmax(np.abs(amplitudes) * (z.imag > 1e-6))]) / dt


def strip(dim):
    """A body and which of its particles are held: those near the surface, where volumes are
    corrected (end corrections), and in 3D all."""
    n = [18, 18] if dim == 2 else [5, 5, 5]
    x = lattice(n, DX)
    depth = np.minimum(x[:, :dim], np.array(n) * DX - x[:, :dim]).min(1)
    return x, depth < (6 * DX if dim == 2 else 9 * DX)


# ---- relaxation ----------------------------------------------------------------------------------


@DIMS
@pytest.mark.parametrize("mode", ["shear", "stretch"])
def test_stress_relaxes_as_the_prony_series(dim, mode):
    """A small step strain that is held: sigma(t) = 2 G(t) dev e + K tr e. The particles inside move
    as they like."""
    x, held = strip(dim)
    e = 1e-4
    with solid(x, held=held) as s:
        s.run()
        y = x.copy()
        y[:, 0] += e * x[:, 1 if mode == "shear" else 0]
        s.put("x", y)
        s.run()
        # at once: that of the instantaneous modulus, but for e^2
        assert close(at(s, held, mode), elastic(e, mode, 1.0), 1e-3)
        for steps in (20, 80, 200, 400):
            s.run(steps)
            # the strain came in the first step, at some time within it: dt/2 of the fastest term,
            # 0.3 x 0.0005/0.02; and e^2
            t = sum(n for n in (20, 80, 200, 400) if n <= steps) * 1e-3
            close(at(s, held, mode), elastic(e, mode, relaxation(t)), 0.01)


def at(s, held, mode):
    return s.sigma[held if held.all() else ~held][:, 0, 1 if mode == "shear" else 0]


def elastic(e, mode, part):
    return part * G * e if mode == "shear" else (K + 4 / 3 * part * G) * e


def test_lateral_stress_of_plane_strain_relaxes():
    """sigma_zz of a strain along x: K e - 2/3 G(t) e."""
    x, held = strip(2)
    e = 1e-4
    with solid(x, held=held) as s:
        s.run()
        y = x.copy()
        y[:, 0] += e * x[:, 0]
        s.put("x", y)
        s.run(100)
        close(s.sigma[~held][:, 2, 2], (K - 2 / 3 * relaxation(0.1) * G) * e, 0.01)


def test_rotation_changes_no_stress():
    """A strained body that turns as a whole by 90 degrees keeps its history: stresses turn with
    it."""
    x = lattice([6, 6], DX, center=True)
    with solid(x, held=np.ones(len(x), bool)) as s:
        s.run()
        F = np.array([[1.1, 0.2], [0.0, 0.95]])
        s.put("x", np.column_stack([x[:, :2] @ F.T, x[:, 2]]))
        before = s.run(30).sigma
        Q = np.array([[0.0, -1.0], [1.0, 0.0]])
        s.put("x", np.column_stack([x[:, :2] @ (Q @ F).T, x[:, 2]]))
        after = s.run().sigma
        R = np.eye(3)
        R[:2, :2] = Q
        close(after, R @ before @ R.T, 1e-10)


# ---- waves and swings ----------------------------------------------------------------------------


@pytest.mark.slow
@DIMS
@pytest.mark.parametrize("wave", ["shear", "axial"])
def test_wave_is_damped_as_the_complex_modulus_says(dim, wave):
    """A standing wave in a periodic body: rho s^2 + k^2 M(s) = 0 with M = G* or K + 4/3 G*; k as
    the gradient of a lattice sees it."""
    n = [24] + [8] * (dim - 1)
    x = lattice(n, DX)
    box = [m * DX for m in n] + [0.0] * (3 - dim)
    k, axis, terms = 2 * np.pi / box[0], 1 if wave == "shear" else 0, ((0.1, 0.05), (0.05, 0.3))
    X = lattice([7] * dim, DX, center=True)
    w = Kernel("wendland", dim, 1.5 * DX).W(np.linalg.norm(X, axis=1)) * X[:, 0]
    seen = w @ np.sin(k * X[:, 0]) / (w @ X[:, 0])
    assert 0.95 < seen / k < 1
    v = np.zeros_like(x)
    mode = np.sin(k * x[:, 0])
    v[:, axis] = 1e-3 * mode

    def stiffness(g):
        return seen**2 / RHO * (g if wave == "shear" else K + 4 / 3 * g)

    s0 = poles(G, stiffness, terms)
    dt = 4e-3
    with solid(x, v, terms, dt=dt, box=((0, 0, 0 if dim == 3 else -DX), box), boundary="p p p",
               keywords="hourglass 0") as s:
        every, a = 5, []
        for _ in range(60):
            s.run(every)
            a.append((s.get("v")[:, axis] * mode).sum())
    measured = damped_swing(np.array(a), every * dt)
    decrement = -2 * np.pi * measured.real / measured.imag, -2 * np.pi * s0.real / s0.imag
    print(f"{wave} wave, {dim}D: frequency {measured.imag / s0.imag - 1:+.4f}, decrement "
          f"{decrement[0]:.4f}, {decrement[1]:.4f}")
    # error of the time step, (w dt)^2/24 = 0.0006 of the axial wave
    assert measured.imag == pytest.approx(s0.imag, rel=0.001)
    assert decrement[0] == pytest.approx(decrement[1], rel=0.01)


def test_free_plate_swings_and_is_damped():
    """Plate of plane strain, as the elastic one but with the complex modulus in D = H^3/12 4 G (3 K
    + G)/(3 K + 4 G)."""
    across, dx, L, H, dt, every = 4, 0.25, 10.0, 1.0, 0.02, 15
    x = lattice([int(L / dx), across], dx)
    v = np.zeros_like(x)
    X = 4.730041 * x[:, 0] / L
    mode = np.cosh(X) + np.cos(X) - 0.982502 * (np.sinh(X) + np.sin(X))
    v[:, 1] = 2e-3 * mode

    def swing(terms):
        a = []
        with solid(x, v, terms, dx=dx, dt=dt) as s:
            for _ in range(140):
                a.append((s.run(every).get("v")[:, 1] * mode).sum())
        return damped_swing(np.array(a), every * dt, 12)

    def bending(g):
        return 4 * g * (3 * K + g) / (3 * K + 4 * g)

    free = swing(())
    thin = 4.730041**2 / L**2 * np.sqrt(bending(G) * H**2 / 12 / RHO)
    terms = ((0.1, 0.3), (0.1, 1.5))
    s0, measured = poles(G, lambda g: free.imag**2 * bending(g) / bending(G), terms), swing(terms)
    decrement = -2 * np.pi * measured.real / measured.imag, -2 * np.pi * s0.real / s0.imag
    print(f"plate: elastic {free.imag / thin - 1:+.4f} of a thin one, frequency "
          f"{measured.imag / s0.imag - 1:+.4f} (elastic {measured.imag / free.imag - 1:+.4f}), "
          f"decrement {decrement[0]:.4f}, {decrement[1]:.4f}")
    # rotary inertia, and shear, whose loss is another than that of bending
    assert free.imag == pytest.approx(thin, rel=0.06)
    assert measured.imag == pytest.approx(s0.imag, rel=0.01)
    assert decrement[0] == pytest.approx(decrement[1], rel=0.05)


# ---- energy --------------------------------------------------------------------------------------


@DIMS
@pytest.mark.parametrize("substeps", [1, 4])
def test_energy_that_is_lost_is_dissipated(dim, substeps):
    """A body that is thrown out of shape by large strains and comes to rest: kinetic and strain
    energy go to entry 12."""
    n = [10, 6] if dim == 2 else [8, 5, 4]
    x = lattice(n, DX, center=True)
    v = np.zeros_like(x)
    v[:, 0] = 6.0 * x[:, 0]
    v[:, 1] = -4.0 * x[:, 1] + 3.0 * x[:, 0]
    with solid(x, v, ((0.4, 0.02), (0.2, 0.1)), dt=1e-3 * substeps / 2,
               density=f"substeps {substeps}", commands=("compute e all fsi/energy",)) as s:
        start = s.run().ledger()
        all_of, lost = [], []
        for _ in range(20):
            e = s.run(40 // substeps).ledger()
            all_of.append(e.sum())
            lost.append(e[11])
    total = start.sum()
    print(f"{dim}D: dissipated {lost[-1] / total:.3f}, sum of all "
          f"{np.abs(np.array(all_of) / total - 1).max():.2e}")
    assert np.diff([0, *lost]).min() > -1e-6 * total and lost[-1] > 0.4 * total
    # error of the time step, of second order; without entry 12 it is all that is dissipated
    assert np.abs(np.array(all_of) / total - 1).max() < 1e-3


# ---- restart, ranks ------------------------------------------------------------------------------

FILE = materials(rubber=material(TERMS))
DECK = box("-1 1 -1 1", DX, "atom_modify map array sort 7 0.3", boundary="p p p",
           bar="-0.8 0.3 -0.3 0.3")
STYLE = ("pair_style fsi/solid/tl law viscoelastic artificial/visc 0.1 0\n"
         "pair_coeff * * rubber.fsi rubber\n")
FIXES = """fix sph all fsi 0.1 wendland 1.5 substeps 2
compute e all fsi/energy
thermo_style custom step c_e c_e[12]
thermo_modify norm no
timestep 2e-3
neighbor 0.03 bin
neigh_modify every 1 delay 0
"""
START = ("velocity all set 8 1 0 units box\nvariable a atom 4*x-3*y\n"
         "velocity all set v_a NULL NULL sum yes units box\n")


RESTARTS = "restart 60 at.*\n"  # both runs build lists, and wrap positions, in the last step


@pytest.mark.parametrize("ranks", [1, 2])
def test_restart_goes_on_bit_for_bit(tmp_path, ranks):
    """Through the periodic boundary, with atoms that change rank and place."""
    deck = DECK + STYLE + FIXES + START
    whole = run(tmp_path / "a", deck + watch(every=60) + RESTARTS + "run 120\n", ranks,
                rubber_fsi=FILE)
    again = "read_restart ../a/at.60\n" + FIXES + watch(every=60) + RESTARTS + "run 60\n"
    rest = run(tmp_path / "b", again, ranks, rubber_fsi=FILE)
    assert differing(whole.frames()[-1], rest.frames()[-1]) == []
    assert "forgotten" not in whole.output


def test_ranks_agree(tmp_path):
    run(tmp_path, DECK + STYLE + FIXES + START + "run 30\nwrite_restart mid\n", rubber_fsi=FILE)
    deck = "read_restart ../mid\n" + FIXES + watch(every=120) + "run 90\n"
    one, two = (run(tmp_path / str(n), deck, n, rubber_fsi=FILE).frames()[-1] for n in (1, 2))
    for name in ("x", "y", "vx", "vy", "sxy"):
        close(two[name], one[name], 1e-9)  # round-off of 90 steps


def test_another_number_of_terms_begins_anew(tmp_path):
    """Between runs with a warning; from a restart file it is an error."""
    other = FILE.replace(" 0.2 0.2\n", "\n")
    assert other != FILE
    deck = (DECK + STYLE + FIXES + START
            + "run 20\nwrite_restart mid\npair_coeff * * other.fsi rubber\nrun 20\n")
    assert "the viscoelastic stress of its bodies is forgotten" in run(
        tmp_path, deck, rubber_fsi=FILE, other_fsi=other).output
    deck = "read_restart mid\n" + STYLE.replace("rubber.fsi", "other.fsi") + FIXES + "run 20\n"
    assert "has 21 numbers of viscoelastic stress for each atom" in lammps(tmp_path, deck).output


def test_two_laws_after_each_other(tmp_path):
    """Another law takes no history, and the first one begins a new one."""
    deck = DECK + STYLE + FIXES + START + "run 20\n" + STYLE.replace(
        "viscoelastic", "neohookean") + "run 20\n" + STYLE + "run 20\n"
    output = run(tmp_path, deck, rubber_fsi=FILE).output
    assert ("Prony series of a material has nothing to act on: pair_style fsi/solid/tl has another "
            "law" in output)


def test_style_that_does_not_relax(tmp_path):
    plain = (DECK + STYLE + FIXES).replace("fsi/solid/tl law viscoelastic",
                                           "fsi/solid").replace(" substeps 2", "")
    output = run(tmp_path, plain + "fix s all fsi/stress\nrun 0\n", rubber_fsi=FILE).output
    assert ("Prony series of a material has nothing to act on: pair_style fsi/solid is elastic or "
            "plastic" in output)


@pytest.mark.parametrize("prony, message", [
    ("prony 0.6 1 0.4 2", r"prony: the sum of all g is 1, expected below 1"),
    ("prony 0.5 0", r"prony tau 0 must be > 0"), ("prony 0.5 -1", r"prony tau -1 must be > 0"),
    ("prony 1 1", r"prony g 1 must be > 0 and < 1"),
    ("prony", r"prony g"), ("prony 0.5", r"prony tau"), ("prony 0.5 young 1", r"prony tau"),
    ("prony 0.1 1 0.2", r"prony tau"),
    ("prony" + 9 * " 0.1 1", r"prony has more than 8 terms")])
def test_bad_series(tmp_path, prony, message):
    done = lammps(tmp_path, DECK + STYLE + FIXES + "run 0\n",
                  rubber_fsi=materials(rubber=f"{RUBBER} {prony}"))
    assert done.status != 0 and message in done.errors[0], done.output[-500:]


def test_bad_style(tmp_path):
    plane = DECK + STYLE.replace("artificial", "plane stress artificial") + FIXES + "run 0\n"
    assert "plane stress requires law svk or hypo" in lammps(tmp_path, plane,
                                                             rubber_fsi=FILE).errors[0]
    none = run(tmp_path, DECK + STYLE + FIXES + "run 0\n", rubber_fsi=materials(rubber=RUBBER))
    assert "law viscoelastic has nothing to act on: no material has a Prony series" in none.output
    fluid = lammps(tmp_path, DECK + STYLE + FIXES + "run 0\n",
                   rubber_fsi=materials(rubber="fluid rho 1000 prony 0.1 1"))
    assert "Unknown keyword prony of fluid" in fluid.errors[0]


def test_time_stands_still(tmp_path):
    """With a time step of 0 nothing relaxes, and nothing moves."""
    first, last = run(tmp_path, DECK + STYLE + FIXES + START + "timestep 0\n" + watch(every=3)
                      + "run 3\n", rubber_fsi=FILE).frames()
    close(last.vector(), first.vector(), 1e-14)
