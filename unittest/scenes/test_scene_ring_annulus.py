"""The theory that the ring in an annulus is judged by, and a short form of the scene."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import scene

ANALYSIS = scene.analysis("ring_annulus")
# solids4foam, test ringAddedMass: angular frequencies [rad/s] by density of the fluid [kg/m^3], to
# the digits given there
PUBLISHED = {0: 2.555042, 14: 2.435615, 140: 1.804513, 1400: 0.768654}


def test_frequencies():
    """Ritz' method is on the published figures, to half of their last digit; its order does not
    matter."""
    for density, omega in PUBLISHED.items():
        assert ANALYSIS.theory(density) == pytest.approx(omega, abs=6e-7)
        assert ANALYSIS.theory(density, terms=5) == pytest.approx(omega, rel=1e-6)


def test_added_mass():
    """Against finite differences of Laplace's equation, (r phi')' = n^2 phi/r, of second order in
    cells of 0.45 mm; and a fluid with much sound."""
    n, count = ANALYSIS.MODE, 1000
    step = (ANALYSIS.RIGID - ANALYSIS.OUTER) / count
    r = ANALYSIS.OUTER + (np.arange(count) + 0.5) * step
    matrix, source = np.diag(-n**2 / r * step), np.zeros(count)
    for k in range(count - 1):
        flux = (r[k] + 0.5 * step) / step
        matrix[k:k + 2, k:k + 2] += flux * np.array([[-1, 1], [1, -1]])
    source[0] = ANALYSIS.OUTER  # phi' = 1 at the ring, 0 at the wall
    phi = np.linalg.solve(matrix, source)
    assert ANALYSIS.added_mass(1.0) == pytest.approx(-(phi[0] - 0.5 * step), rel=1e-5)
    assert ANALYSIS.compressible_mass(1.0, 1e-3) == pytest.approx(ANALYSIS.added_mass(1.0),
                                                                  rel=1e-5)


def test_closed_form():
    """omega_wet/omega_dry = 1/sqrt(1 + mu) of a thin ring; its thickness matters by up to the
    square of h/a, here a fifth of that."""
    for density in (14, 140, 1400):
        assert 1.0 / np.sqrt(1.0 + ANALYSIS.mass_ratio(density)) == pytest.approx(
            PUBLISHED[density] / PUBLISHED[0], rel=0.2 * 0.1**2)


def test_swing():
    time = np.linspace(0.0, 3.0, 400)
    found = ANALYSIS.swing(time, 2e-6 * np.exp(-0.03 * time) * np.sin(1.8 * time) + 1e-8, 1.75)
    assert found[:3] == pytest.approx((1.8, 0.03, 2e-6), rel=1e-4)


def test_ratio(tmp_path):
    """Half a period, 4 particles through the ring: the target of the scene, 0.5 %, and its damping,
    2 % a period."""
    wet, dry = (run_scene(tmp_path / str(density), "ring_annulus", density=density, tend=tend)
                for density, tend in ((140, 1.9), (0, 1.4)))
    assert wet["frequency"] / dry["frequency"] == pytest.approx(PUBLISHED[140] / PUBLISHED[0],
                                                                rel=0.005)
    assert 0.0 < wet["damping_a_period"] < 0.02
    assert abs(dry["damping_a_period"]) < 1e-4
