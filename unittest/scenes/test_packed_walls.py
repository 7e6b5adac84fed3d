"""No slip at walls that fsi/pack has made: flow through a round pipe, and past an array of
cylinders, against closed forms."""

import math

import numpy as np
import pytest
from decks import WALL, materials, start
from scenes import run

from fsi import dump

NU, RHO = 1e-3, 1000.0
OIL = materials(oil=f"fluid rho {RHO:g} viscosity {RHO * NU:g}", wall=WALL)
PHYSICS = """group water type 1
group wall type 2
pair_style fsi/fluid preset stream {speed} sound {sound}
pair_coeff * * oil.fsi oil wall
fix 1 water fsi {dx}
fix 2 wall fsi/wall/particle slip no
neighbor {skin} bin
timestep {dt}
"""


def physics(dx, speed, h):
    """Slow flow: the step is that of viscosity."""
    sound = max(10 * speed, NU / dx)
    return PHYSICS.format(dx=dx, speed=speed, sound=sound, skin=0.3 * dx,
                          dt=0.8 * min(0.4 * dx / sound, 0.125 * h**2 / NU))


def end_of(tmp_path, text, time):
    """Of the fluid, at five instants: (positions, velocities)"""
    text += f"""variable n equal ceil({time}/dt/20)
dump d all custom $n atoms.dump id type x y z vx vy vz
dump_modify d sort id time yes format float %.12g
run $(20*v_n)
"""
    frames = dump.read(run(tmp_path, text, oil_fsi=OIL).folder / "atoms.dump")[-5:]
    return [(f.vector()[f["type"] == 1], f.vector(("vx", "vy", "vz"))[f["type"] == 1])
            for f in frames]


def pipe(tmp_path, n):
    """A pipe of radius 1, n spacings, a short period of it: mean velocity over Hagen's and
    Poiseuille's; place of no slip, beyond the wall, in spacings: where the parabola with the
    pressure's curvature that fits the flow inside is zero"""
    dx, speed = 1 / n, 1e-3
    side = (n + 8) * dx
    text = start(dim=3, boundary="p p p") + f"""region box block -{side} {side} -{side} {side} 0 {6 * dx} units box
create_box 2 box
lattice sc {dx} origin 0.5 0.5 0.5
create_atoms 1 box
region away cylinder z 0 0 {1 - 6.2 * dx} INF INF side out units box
create_atoms 2 region away
{physics(dx, speed, 1.5 * dx)}region outside cylinder z 0 0 1 INF INF side out units box
fsi/pack wall water region outside
region far cylinder z 0 0 {1 + 4 * dx} INF INF side out units box
group far region far
delete_atoms group far compress no
fix g water gravity {4 * NU * speed} vector 0 0 1
variable u atom {speed}*(1-x*x-y*y)
velocity water set 0 0 v_u
"""
    places, mean = [], []
    for x, v in end_of(tmp_path, text, 0.35 / NU):
        rr, u = x[:, 0]**2 + x[:, 1]**2, v[:, 2] / speed
        places.append((rr + u)[rr < (1 - 2.5 * dx)**2])
        mean.append(2 * u.mean())
    return np.mean(mean), (math.sqrt(np.concatenate(places).mean()) - 1) / dx


def test_pipe(tmp_path):
    (coarse, off_coarse), (fine, off) = [pipe(tmp_path / str(n), n) for n in (7, 11)]
    print(f"pipe, R = 7, 11 dx: {coarse:.4f}, {fine:.4f} of the mean velocity, no slip "
          f"{off_coarse:+.3f}, {off:+.3f} dx beyond the wall")
    assert abs(off_coarse) < 0.1 and abs(off) < 0.1
    assert abs(fine - 1) < 0.025 and abs(fine - 1) < 0.5 * abs(coarse - 1)


def test_array_of_cylinders(tmp_path):
    """Slow flow across a square array, a tenth of the area in cylinders of 12 spacings: force over
    superficial velocity (Sangani and Acrivos 1982). The force is the pressure gradient times the
    whole area: what pushes the fluid does not push the cylinders, so theirs lacks the tenth."""
    dx, speed, n = 1 / 12, 2e-4, 34
    side = n * dx
    c = math.pi / 4 / side**2
    exact = 4 * math.pi / (-0.5 * math.log(c) - 0.738 + c - 0.887 * c**2 + 2.038 * c**3)
    push = exact * NU * speed / side**2
    text = start(boundary="p p p") + f"""region box block 0 {side} 0 {side} {-dx / 2} {dx / 2} units box
create_box 2 box
lattice sq {dx} origin 0.5 0.5 0
create_atoms 1 box
region near cylinder z {side / 2} {side / 2} {0.5 + 6.2 * dx} INF INF units box
create_atoms 2 region near
{physics(dx, 3 * speed, dx)}region disc cylinder z {side / 2} {side / 2} 0.5 INF INF units box
fsi/pack wall water region disc
velocity water set {speed} 0 0
fix g water gravity {push} vector 1 0 0
fix force all ave/time 10 1 10 f_2[1] file force.txt
"""
    flow = (1 - c) * np.mean([v[:, 0].mean() for _, v in end_of(tmp_path, text, 3.4 / NU)]) / speed
    force = np.loadtxt(tmp_path / "force.txt")[-20:, 1].mean() / (RHO * push * side**2)
    print(f"array of cylinders of 12 dx: {1 / flow:.4f} of the drag, {force:.4f} of it on the "
          f"cylinder, {1 - c:.4f} of the area is fluid")
    assert force == pytest.approx(1 - c, abs=0.01)
    assert 1 / flow == pytest.approx(1, abs=0.05)
