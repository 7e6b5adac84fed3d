"""The beam that the flexible plate is compared with, the plate's stiffness without water, and a
short form of the scene."""

import numpy as np
import pytest
from decks import box
from scenes import run, run_scene

from fsi import scene, series

ANALYSIS = scene.analysis("flexible_plate")


def test_beam():
    """A weak load: Euler's cantilever under a uniform one. Under the real one a shooting from the
    free end, with steps of its own, gives the same."""
    length, stiffness = ANALYSIS.LENGTH, ANALYSIS.STIFFNESS
    dx, dz = ANALYSIS.beam(1e-3, buoyancy=0.0)
    assert dx == pytest.approx(0.5e-3 * length**4 / (8 * stiffness), rel=1e-3)
    assert 0 <= dz < 1e-3 * dx
    dx, dz = ANALYSIS.beam(1.0)

    def foot(end, factor, steps=2000):
        """from the end, whose angle is `end`, to the foot: angle there, drag, dx, dz"""
        ds = length / steps
        angle, curvature, ahead, up, x, z = end, 0.0, 0.0, 0.0, 0.0, 0.0
        for _ in range(steps):
            middle = angle - 0.5 * ds * curvature
            force = factor * np.cos(middle)**2
            a, b = ahead + 0.5 * ds * force * np.cos(middle), up + 0.5 * ds * (
                ANALYSIS.BUOYANCY - force * np.sin(middle))
            ahead, up = 2 * a - ahead, 2 * b - up
            turn = (a * np.cos(middle) - b * np.sin(middle)) / stiffness
            angle -= ds * (curvature + 0.5 * ds * turn)
            curvature += ds * turn
            x, z = x + ds * np.sin(middle), z + ds * np.cos(middle)
        return angle, ahead / (0.5 * length), x, length - z

    # end and factor, by Newton's method, so that the foot is upright and the drag 1
    found = np.array([0.7, 0.7])
    for _ in range(20):
        def miss(values):
            return np.array(foot(*values)[:2]) - (0.0, 1.0)
        slopes = np.stack([(miss(found + h) - miss(found - h)) / 2e-6 for h in 1e-6 * np.eye(2)],
                          axis=1)
        found -= np.linalg.solve(slopes, miss(found))
    assert (dx, dz) == pytest.approx(foot(*found)[2:], rel=1e-3)


def test_stiffness(tmp_path):
    """Two particles across and in width, in air, under a dead load of half of rho U^2 times its
    width: an inextensible beam has 2.454 and 0.749 b (scipy's solve_bvp). The whole width gave
    2.455 and 0.765 b, at the end of 1.2 s."""
    run(tmp_path, box("-0.05 0.08 -0.02 0.02 -0.004 0.06", 0.001, dim=3, types=2, plate="-0.001 0.001 -0.001 0.001 -0.003 0.05") + """region foot block INF INF INF INF INF 0.001001 units box
set region foot type 2
group free type 1
pair_style fsi/solid/tl artificial/visc 0.05 0
pair_coeff * * materials.fsi foam foam
fix sph free fsi 0.001 quintic 1.0
fix load free addforce $(0.5*1000*0.16^2*0.002*0.05/count(free)) 0 0
fix damp free viscous $(40*678*1e-9)
fix dt all fsi/dt 10 stop 0.3
neighbor 0.002 bin
region end block INF INF INF INF 0.049 INF units box
group end region end
compute disp all displace/atom
compute end end reduce ave c_disp[1] c_disp[3]
run 1000000000
print "$(c_end[1]/0.01),$(-c_end[2]/0.01)" file end.csv
""")
    dx, dz = np.loadtxt(tmp_path / "end.csv", delimiter=",")
    # the last row is half a spacing below the end, at an angle of 40 degrees to the vertical or so
    assert dx == pytest.approx(2.454 - 0.05 * np.sin(0.72), rel=0.015)
    assert dz == pytest.approx(0.749 - 0.05 * (1 - np.cos(0.72)), rel=0.04)


def test_bends(tmp_path):
    """In the first b/U the plate goes with the water until it resists, and does not go aside. The
    spacing and the duct are coarser and narrower than the scene's, which has gone 1.2 to 1.3 b by
    then."""
    figures = run_scene(tmp_path, "flexible_plate", dx=0.4, width=4, height=6, length=8, tend=1,
                        frames=1)
    s = series.read(tmp_path / "series.csv")
    assert 0.9 < s["ux"][-1] < 1.7 and 0.05 < -s["uz"][-1] < 0.4
    assert np.abs(s["uy"]).max() < 0.02
    assert abs(figures["flow"] - 1.0) < 0.03
