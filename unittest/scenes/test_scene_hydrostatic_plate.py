"""Short form of the plate under water: three particles across."""

import pytest
from scenes import run_scene


def test_plate_carries_the_water(tmp_path):
    # finite elements: -70.66 micrometre. The clamps stand a quarter of a spacing off each: 3 % of
    # the deflection with three particles across; hydrostatic pressure is good to 1.5 %. Twice their
    # sum
    figures = run_scene(tmp_path, "hydrostatic_plate", across=3, tdamp=0.1, tend=0.13)
    assert figures["deflection"] == pytest.approx(-70.66, rel=0.09)
    assert abs(figures["drift"]) < 0.01
    assert figures["pressure_l2"] < 0.02
    assert figures["particles_leaked"] == 0
