"""Short forms of the scenes of fluids with a yield stress or a power law: yield_channel, slump. A disc that is pushed through such a fluid."""

import math

import numpy as np
import pytest
from scenes import run, run_scene

# 10 particles per diameter, tau_y D/(K U) = 1000, m U/D = 100: nearly a rigid, perfectly plastic soil
DISC = """units si
dimension 2
boundary f f p
atom_style fsi
region box block -3.6 3.6 -3.6 3.6 -0.05 0.05
create_box 2 box
lattice sq 0.1 origin 0.5 0.5 0
region gel block -3 3 -3 3 INF INF units box
region near block -1.1 1.1 -1.1 1.1 INF INF units box
region disc cylinder z 0 0 0.5 INF INF units box
create_atoms 1 region gel
create_atoms 2 region near
group gel type 1
group disc type 2
fsi/material gel fluid rho 100 herschel/bulkley 1000 1 1 100
fsi/material disc wall rho 100
pair_style fsi/fluid sound 100 tension yes laminar/visc laminar/implicit yes density/diffusion 0.1
pair_coeff * * NULL gel disc
neighbor 0.04 bin
fix 1 gel fsi 0.1 wendland 1.5
fix 3 gel fsi/wall/mirror xlo -3 slip no xhi 3 slip no ylo -3 slip no yhi 3 slip no
fix 4 disc fsi/wall/particle slip no
fsi/set gel volume 0.01
fsi/pack disc gel region disc
fix 5 disc fsi/move linear 1 0 0 units box
fix 6 all fsi/dt 1 stop 0.3
compute f disc fsi/force
thermo_style custom step time c_f[1]
fix 7 all print 1 "$(time) $(c_f[1])" file force.txt screen no
run 1000000
"""


def test_power_law_in_a_channel(tmp_path):
    # 20 rows. Closed form of mean over largest: (n+1)/(2n+1); the scene has -0.1 % with 40 rows, of second order
    figures = run_scene(tmp_path, "yield_channel", rows=20, law="power 1 0.5 viscosity/limits 0 1000", tend=3)
    assert figures["mean_over_largest"] == pytest.approx(0.75, rel=0.01)
    assert figures["velocity_error"] < 0.015


def test_yield_stress_in_a_channel(tmp_path):
    # 20 rows, of which 5 yield at either wall: a kernel smooths the rate over one of them. Center of the law with m = 100:
    # (1-0.5)^2/2 + 0.5/100. Stopping times: finite differences, those of the scene's analysis for the regularized law
    figures = run_scene(tmp_path, "yield_channel", rows=20, tend=3)
    assert figures["center_velocity"] == pytest.approx(0.13, rel=0.03)
    assert figures["stops_0.1"] == pytest.approx(0.133, rel=0.03)
    assert figures["stops_0.01"] == pytest.approx(0.160, rel=0.03)


def test_slump(tmp_path):
    # 10 rows, reference: the lubrication equation of the law with m by finite differences. Spread: -0.2 % at 2 s, -2.3 % at 25 s. Lubrication is
    # of first order in the square of the slope, here up to 0.1. The closed form of the arrested layer is 6 % wider than that at 8 s
    figures = run_scene(tmp_path, "slump", dx=0.01, tend=8)
    assert figures["error_of_spread_2_s"] < 0.04 and figures["error_of_spread_8_s"] < 0.04
    assert 0.9 * 0.2805 < figures["spread"] < 0.2805
    assert figures["height_at_wall"] == pytest.approx(0.0535, rel=0.1)


def test_disc_that_is_pushed(tmp_path):
    """The limit load of a rough disc is (4 sqrt(2) + 2 pi) tau_y D, of a smooth one (6 + pi) tau_y D (Randolph and Houlsby, Geotechnique 34
    (1984) 613): below it a disc stays where it is. Mean over two periods of the box's sound: -2 % with 10 particles per diameter, -8 % with 16.
    Bounds: the layer that yields next to the disc is D/30 thick, less than a spacing, so that the disc may seem smoother than it is.
    """
    run(tmp_path, DISC)
    t, force = np.loadtxt(tmp_path / "force.txt", skiprows=1).T
    found = -force[t > 0.1].mean() / 1000
    assert found == pytest.approx(4 * math.sqrt(2) + 2 * math.pi, rel=0.1)
    assert found > 1.1 * (6 + math.pi)
