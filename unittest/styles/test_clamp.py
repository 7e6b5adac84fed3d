"""Elastic bodies with a rigid part that fix rigid moves, and sub-steps."""

import numpy as np
import pytest
from scenes import Scene, lattice, run, watch

DX, RHO, E = 0.01, 1000.0, 1.0e6


def beam(n, block, substeps, dt, *, v=None, young=E, poisson=0.3, rigid="force * on on off torque * off off on", commands=(), **more):
    """A beam along x, free in a void, whose last spacings are rigid: (scene, who is rigid)."""
    x = lattice(n, DX)
    tip = x[:, 0] > (n[0] - block) * DX
    if v is None:    # flight, spin, and a bend
        v = np.zeros_like(x)
        arm = x - x.mean(0)
        v[:, 0] = 0.4 - 3.0 * arm[:, 1]
        v[:, 1] = -0.3 + 3.0 * arm[:, 0]
        if len(n) == 3:
            v[:, 1] -= 2.0 * arm[:, 2]
            v[:, 2] = 2.0 * arm[:, 1] + 0.1
        v[~tip, 1] += 0.5 * np.sin(np.pi * x[~tip, 0] / x[:, 0].max())
    options = {"dim": len(n), "dx": DX, "dt": dt, "materials": (f"solid rho {RHO} young {young} poisson {poisson}",), "solid_style": "fsi/solid/tl",
               "solid": "artificial/visc 0 0", "held": tip, "density": f"substeps {substeps}", **more}
    return Scene(x, v, commands=[f"fix tip held rigid single {rigid}", "compute e all fsi/energy", *commands], **options), tip


def momenta(s):
    """of all particles, as they stand: linear, angular; and their sizes"""
    m, x, v = s.get("rmass")[:, None], s.get("x"), s.get("v")
    turn = m * np.cross(x, v)
    return (m * v).sum(0), turn.sum(0), np.abs(m * v).sum(), np.abs(turn).sum()


@pytest.mark.parametrize("n, block", [([24, 4], 6), ([24, 4], 1), ([14, 3, 4], 4)])
@pytest.mark.parametrize("substeps", [10, 40])
def test_momenta_and_energy_of_a_free_beam(n, block, substeps):
    """Linear and angular momentum to round-off, over several runs; energy without drift over some 16 periods, whether the rigid part is
    heavier than the elastic mass that sound crosses in a step, or is far lighter: there is no ratio at which it turns unstable."""
    flags = "force * on on off torque * off off on" if len(n) == 2 else ""
    s, _ = beam(n, block, substeps, 2e-5 * substeps, rigid=flags)
    with s:
        s.run()
        start, energy = momenta(s), s.ledger().sum()
        off = []
        for _ in range(5):
            s.run(round(0.08 / (2e-5 * substeps)))
            now = momenta(s)
            assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
            assert np.abs(now[1] - start[1]).max() < 1e-12 * start[3]
            off.append(s.ledger().sum() / energy - 1)
        print(f"{n}, {block} rigid, {substeps} sub-steps: energy {np.array(off)}, strain {s.ledger()[3] / energy:.3f}")
        assert np.abs(off).max() < 5e-4


# ---- against closed forms and against none ----------------------------------------------------------------------------------


def test_period_of_a_rod_with_a_rigid_end():
    """Free rod of length L and mass m, mass M at its end, along its axis: tan kL = -kL M/m, from EA u' = M u'' at the mass. The clamp acts a
    spacing inside the rigid part."""
    n, block, young = [40, 4], 11, 1e6
    L, heavy = (n[0] - block + 1) * DX, (block - 1) / (n[0] - block + 1)
    low, high = np.pi / 2 + 1e-9, np.pi
    for _ in range(60):
        mid = (low + high) / 2
        low, high = (mid, high) if np.tan(mid) + mid * heavy < 0 else (low, mid)
    omega = low / L * np.sqrt(young / RHO)
    x = lattice(n, DX)
    v = np.zeros_like(x)
    v[:, 0] = 0.05 * np.cos(low / L * np.minimum(x[:, 0], L))
    v[x[:, 0] > L, 0] = 0.05 * np.cos(low)
    substeps, dt = 8, 8e-5
    s, tip = beam(n, block, substeps, dt, v=v, poisson=0.0)
    with s:
        gap = []
        for _ in range(int(4 * np.pi / omega / dt * 1.2)):
            s.run(1)
            now = s.get("v")[:, 0]
            gap.append(now[:4].mean() - now[tip].mean())
    gap = np.array(gap)
    falls = np.flatnonzero((gap[:-1] > 0) & (gap[1:] <= 0))
    times = (falls + gap[falls] / (gap[falls] - gap[falls + 1])) * dt
    period = times[1] - times[0]
    print(f"rod with a rigid end: period {period:.5f} s, of theory {2 * np.pi / omega:.5f}, off {period * omega / 2 / np.pi - 1:+.4f}")
    assert abs(period * omega / (2 * np.pi) - 1) < 0.01


@pytest.mark.parametrize("dim", [2, 3])
def test_same_motion_as_without_substeps(dim):
    """Substeps 1, where fix rigid moves the part itself, with the short step; velocity Verlet of the rigid part and position Verlet of the rest
    stand half a step apart there. 1 % of the displacement."""
    n, ends = [20, 4] if dim == 2 else [12, 3, 3], []
    for substeps in (1, 12):
        s, _ = beam(n, 5, substeps, 1e-5 * substeps, rigid="force * on on off torque * off off on" if dim == 2 else "")
        with s:
            s.run()
            x = s.get("x")
            s.run(6000 // substeps)
            ends.append(s.get("x"))
    middle = (ends[0] - x).mean(0)
    bent = np.abs(ends[0] - x - middle).max()    # turned and bent, without the common flight
    print(f"{dim}D: moved {np.abs(middle).max():.4f}, turned and bent {bent:.4f}, apart {np.abs(ends[1] - ends[0]).max() / bent:.1e} of it")
    assert np.abs(ends[1] - ends[0]).max() < 0.01 * bent


def test_momenta_and_energy_in_water():
    """A drop in a void around a beam with a rigid part, that flies and spins in it: linear momentum to round-off. The force of water acts where
    bodies are in the middle of the step, and is held in the sub-steps: angular momentum to the second order of the step. So is energy, but its
    balance takes powers with the velocities of the start of the step, and is of the first order, as with any sub-steps."""
    x = lattice([28, 24], DX)
    inner = (x[:, 0] > 7 * DX) & (x[:, 0] < 21 * DX) & (x[:, 1] > 10 * DX) & (x[:, 1] < 14 * DX)
    tip = inner & (x[:, 0] > 16 * DX)
    arm = x - x.mean(0)
    v = np.zeros_like(x)
    v[inner, 0], v[inner, 1] = 0.2 - 2.0 * arm[inner, 1], -0.1 + 2.0 * arm[inner, 0]
    off = []
    for dt in (4e-4, 2e-4, 1e-4):
        with Scene(x, v, dx=DX, type=1 + inner, mol=1 + inner, materials=("fluid rho 1000", f"solid rho 700 young {E} poisson 0.3"), held=tip, dt=dt,
                   solid_style="fsi/solid/tl", fluid="sound 10 extrapolate yes artificial/visc 0.05 0", density="substeps 16",
                   commands=["fix tip held rigid single force * on on off torque * off off on", "compute e all fsi/energy"]) as s:
            s.run()
            start, energy = momenta(s), s.ledger()
            s.run(round(0.08 / dt))
            now = momenta(s)
            assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
            off.append((abs(now[1][2] - start[1][2]) / start[3], abs(s.ledger().sum() - energy.sum()) / energy[0]))
            moved = np.abs(s.get("x")[inner] - x[inner]).max() / DX
    print(f"in water, moved {moved:.1f} dx: angular momentum and energy off by {off}")
    off = np.array(off)
    assert moved > 0.5 and (off[0] < [1e-5, 0.02]).all() and (off[1:] < [0.3, 0.6] * off[:-1]).all()


def test_steps_without_substeps_between():
    """Fix fsi/dt may choose one in a step: the rigid part then takes its step whole, with the same momenta."""
    s, _ = beam([20, 4], 5, 4, 4e-5)
    with s:
        s.run()
        start = momenta(s)
        for substeps, dt in ((4, 8e-5), (1, 2e-5), (4, 8e-5)):
            s.run_lines(f"timestep {dt}", "unfix tip", "unfix sph", f"fix sph moving fsi {DX} wendland 1.5 substeps {substeps}",
                        "fix tip held rigid single force * on on off torque * off off on")
            s.run_lines(f"fix step all fsi/dt {1 if substeps == 1 else 1000} substeps auto max {dt}")
            s.run(400)
            now = momenta(s)
            assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
            assert np.abs(now[1] - start[1]).max() < 1e-12 * start[3]
            s.run_lines("unfix step")


# ---- whole programs -----------------------------------------------------------------------------------------------------------

DECK = """
units si
dimension 2
boundary p p p
atom_style fsi
newton {newton}
processors {grid}
read_data beams.data
group one id 57:80
group two id 81:100
group stiff union one two
group soft subtract all stiff
velocity all set 4 2 0 units box
velocity soft set 4.2 1.7 0 units box
pair_style fsi/solid/tl artificial/visc 0.1 0
pair_coeff * * rubber.fsi rubber rubber
neighbor 0.003 bin
neigh_modify every 1 delay 0 check yes
comm_modify cutoff 0.042
thermo_modify norm no lost error
fix sph soft fsi 0.01 wendland 1.5 substeps 6
fix tip stiff rigid group 2 one two force * on on off torque * off off on
timestep 1e-4
"""
RUBBER = "# DATE: 2026-01-01 UNITS: si CITATION: none\nrubber solid rho 1000 young 1e6 poisson 0.3\n"



def beams():
    """Type 1 along x, type 2 along y; IDs column by column of the first, row by row of the second, 4 of them in each."""
    one, two = lattice([20, 4], DX, origin=[0.055, 0.055]), lattice([4, 20], DX, origin=[0.305, 0.085])
    one, two = one[np.lexsort((one[:, 1], one[:, 0]))], two[np.lexsort((two[:, 0], two[:, 1]))]
    lines = ["two beams", "", "160 atoms", "2 atom types", "", "0 0.4 xlo xhi", "0 0.3 ylo yhi", "-0.005 0.005 zlo zhi", "", "Atoms # fsi", ""]
    lines += [f"{k + 1} {1 + k // 80} {1 + k // 80} 0 0 {p[0]!r} {p[1]!r} 0" for k, p in enumerate(np.vstack([one, two]).tolist())]
    return "\n".join(lines) + "\n"


FILES = {"rubber_fsi": RUBBER, "beams_data": beams()}


def deck(newton="on", grid="* * *"):
    return DECK.format(newton=newton, grid=grid)


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    return run(tmp_path_factory.mktemp("one"), deck() + watch(every=500) + "run 1500", **FILES).frames()


def apart(a, b):
    """largest difference of positions, up to periodic images, and of velocities"""
    box = np.array([0.4, 0.3, 0.01])
    d = a.vector() - b.vector()
    return np.abs(d - np.round(d / box) * box).max(), np.abs(a.vector(("vx", "vy", "vz")) - b.vector(("vx", "vy", "vz"))).max()


@pytest.mark.parametrize("ranks, grid, newton", [(1, "1 1 1", "off"), (2, "2 1 1", "on"), (2, "1 2 1", "off"), (4, "2 2 1", "on"), (4, "2 2 1", "off")])
def test_ranks(tmp_path, one_rank, ranks, grid, newton):
    """Two beams with rigid parts cross a periodic box more than once: as on one rank, to round-off that vibrations have grown from 1e-16."""
    got = run(tmp_path, deck(newton, grid) + watch(every=500) + "run 1500", ranks, **FILES).frames()
    for a, b in zip(one_rank, got):
        x, v = apart(a, b)
        assert x < 1e-12 and v < 1e-9, (x, v)


def test_restart(tmp_path, one_rank):
    """Fix rigid keeps no state in the file and finds its bodies again from positions and velocities of particles: as good as those are, not bit
    for bit."""
    run(tmp_path / "first", deck() + "run 500\nwrite_restart state.restart", **FILES)
    again = deck().split("pair_style")[1].split("thermo_modify")
    text = "units si\nread_restart ../first/state.restart\n" + "pair_style" + again[0] + "thermo_modify" + again[1]
    got = run(tmp_path / "second", text + watch(every=500) + "run 1000", **FILES).frames()
    for a, b in zip(one_rank[1:], got):
        x, v = apart(a, b)
        print(f"restart: {x:.1e} m, {v:.1e} m/s")
        assert x < 1e-13 and v < 1e-10, (x, v)


# ---- what does not go ---------------------------------------------------------------------------------------------------------


def test_fix_rigid_comes_after_fix_fsi():
    """Else it would sum forces that the sub-steps have not found yet."""
    s, _ = beam([12, 4], 4, 4, 4e-5, commands=["unfix sph", f"fix sph moving fsi {DX} wendland 1.5 substeps 4"])
    with s, pytest.raises(Exception, match=r"Fix tip \(style rigid\) moves particles of elastic bodies with sub-steps: expected after fix"):
        s.run()


def test_early_forces_are_refused():
    s, _ = beam([12, 4], 4, 4, 4e-5, commands=["fix_modify tip bodyforces early"])
    with s, pytest.raises(Exception, match="Fix tip .* expected bodyforces"):
        s.run()


@pytest.mark.parametrize("style", ["rigid/nve single", "rigid/small molecule", "rigid/nve/small molecule"])
@pytest.mark.parametrize("auto", [False, True])
def test_other_styles_are_refused(style, auto):
    """They keep their bodies in another way; a run of no steps, as that of `fsi check`, says so where fix fsi/dt may choose sub-steps."""
    s, _ = beam([12, 4], 4, 1 if auto else 4, 1e-5, commands=["unfix tip", f"fix tip held {style}", "fix d all fsi/dt 1 substeps auto" if auto else ""])
    with s, pytest.raises(Exception, match=r"Fix tip \(style rigid.*\) moves a part of the elastic body of atom \d+"):
        s.run()


def test_known_motion_needs_no_fix_rigid():
    s, _ = beam([12, 4], 4, 4, 4e-5, commands=["unfix tip", "fix tip held fsi/move linear 0.4 0 0"])
    with s:
        s.run()
