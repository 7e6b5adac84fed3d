"""A plate of five particles, made along the axes and turned, as doc/src/Howto_turned.rst says: dry,
and in water that is packed around it."""

import math

import numpy as np
import pytest
from scenes import lammps

from fsi import series

# The deck of examples/oscillating_plate: the first mode's velocity in the frame of the plate, which
# is turned with it.
DRY = """units si
dimension 2
boundary f f p
atom_style fsi
region box block -0.3 0.3 -0.3 0.3 -0.002 0.002
create_box 2 box
lattice sq 0.004 origin 0.5 0 0
region plate block -0.028 0.2 -0.01 0.01 INF INF units box
region free block 0.004 INF INF INF INF INF units box
create_atoms 2 region plate
set group all mol 1
set region free type 1
group plate type 1
variable a atom exp(9.375*x)
variable b atom 0.285043859139074*((v_a+1/v_a)/2-cos(9.375*x))-0.209229887360026*((v_a-1/v_a)/2-sin(9.375*x))
variable vx atom -{s}*v_b
variable vy atom {c}*v_b
velocity plate set v_vx v_vy NULL
region tip block 0.196 INF INF INF INF INF units box
group tip region tip
displace_atoms all rotate 0 0 0 0 0 1 {angle} units box
pair_style fsi/solid/tl
pair_coeff * * materials.fsi plate plate
neighbor 0.008 bin
fix 1 plate fsi 0.004 wendland 1.5
fix 2 all fsi/dt 10 cfl 1.6 stop 0.45
variable tip equal {c}*xcm(tip,y)-{s}*xcm(tip,x)
variable time equal time
fix 3 all print 10 "${{time}},${{tip}}" file tip.csv title "time,tip" screen no
thermo_style custom step time
run 1000000
"""

# A disc of water, free at its rim, has no direction, nor has a weight across the plate. It bends to
# its first stop.
WET = """units si
dimension 2
boundary f f p
atom_style fsi
region box block -0.3 0.3 -0.3 0.3 -0.002 0.002
create_box 2 box
lattice sq 0.004 origin 0.5 0 0
variable turned equal {angle}*PI/180
region plate block -0.1 0.1 -0.01 0.01 INF INF units box
region surface block -0.1 0.1 -0.01 0.01 INF INF rotate v_turned 0 0 0 0 0 1 units box
region clamp block INF -0.068 INF INF INF INF units box
region tip block 0.096 INF INF INF INF INF units box
create_atoms 2 region plate
group plate type 2
set group plate mol 1
group clamp region clamp
group tip region tip
displace_atoms plate rotate 0 0 0 0 0 1 {angle} units box
region water cylinder z 0 0 0.16 INF INF units box
create_atoms 1 region water
group water type 1
group moves subtract all clamp
pair_style hybrid fsi/fluid sound 20 extrapolate yes artificial/visc 0.05 0 density/diffusion 0.1 fsi/solid/tl artificial/visc 0.1 0
pair_coeff * * fsi/fluid materials.fsi water_inviscid rubber_silicone
pair_coeff * * fsi/solid/tl materials.fsi NULL rubber_silicone
neighbor 0.0016 bin
fix 1 moves fsi 0.004 wendland 1.5
fsi/pack NULL water region surface still plate
fix 2 plate gravity 20 vector {s} -{c} 0
fix 3 all fsi/dt 10 substeps auto stop 0.11
variable tip equal {c}*xcm(tip,y)-{s}*xcm(tip,x)
variable time equal time
fix 4 all print 10 "${{time}},${{tip}}" file tip.csv title "time,tip" screen no
thermo_style custom step time
run 1000000
"""


def swing(folder, text, angle):
    """(time, height of the last column in the frame of the plate)"""
    turn = math.radians(angle)
    done = lammps(folder, text.format(angle=angle, c=math.cos(turn), s=math.sin(turn)))
    assert done.status == 0 and not done.errors
    s = series.read(folder / "tip.csv")
    return s.time, s["tip"]


def half_period(time, tip):
    """From the first to the last crossing of the rest, by their number"""
    k = np.flatnonzero(tip[1:-1] * tip[2:] < 0) + 1
    at = time[k] - tip[k] * (time[k + 1] - time[k]) / (tip[k + 1] - tip[k])
    return (at[-1] - at[0]) / (len(at) - 1)


@pytest.mark.parametrize("angle", [5, 10, 22, 45])
def test_period(tmp_path, angle):
    """0.2553 s: finite elements of unittest/elements.py (scene oscillating_plate). Five particles
    lack 0.3 %; cut from a lattice at 10 degrees: +17 %."""
    of = [2 * half_period(*swing(tmp_path / str(a), DRY, a)) for a in (0, angle)]
    assert of[1] == pytest.approx(of[0], rel=1e-6)  # the same sums in another order
    assert of[1] == pytest.approx(0.2553, rel=0.01)


def test_in_water(tmp_path):
    """The water's lattice is turned against the plate's by 22 degrees. Measured: deflection 0.0 %,
    time 0.1 % off; the bound is the issue's 1 %."""
    stops = []
    for angle in (0, 22):
        time, tip = swing(tmp_path / str(angle), WET, angle)
        k = tip.argmin()
        assert 5 < k < len(tip) - 5
        a, b, c = np.polyfit(time[k - 4:k + 5] - time[k], tip[k - 4:k + 5], 2)
        stops.append((time[k] - b / (2 * a), c - b * b / (4 * a)))
    assert stops[1] == pytest.approx(stops[0], rel=0.01)
