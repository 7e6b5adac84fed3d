"""Short forms of the scenes of fluids with a yield stress or a power law: yield_channel, slump."""

import pytest
from scenes import run_scene


def test_power_law_in_a_channel(tmp_path):
    # 20 rows. Closed form of mean over largest: (n+1)/(2n+1); the scene has -0.1 % with 40 rows, of second order
    figures = run_scene(tmp_path, "yield_channel", rows=20, law="power 1 0.5 viscosity/limits 0 1000", tend=3)
    assert figures["mean_over_largest"] == pytest.approx(0.75, rel=0.01)
    assert figures["velocity_error"] < 0.015


def test_yield_stress_in_a_channel(tmp_path):
    # 20 rows, of which 5 yield at either wall: a kernel smooths the rate over one of them. Center of the law with m = 100:
    # (1-0.5)^2/2 + 0.5/100. Stopping times: finite differences, the rows of table 2b 6 of the regularized law begin at the exact one
    figures = run_scene(tmp_path, "yield_channel", rows=20, tend=3)
    assert figures["center_velocity"] == pytest.approx(0.13, rel=0.03)
    assert figures["stops_0.1"] == pytest.approx(0.133, rel=0.03)
    assert figures["stops_0.01"] == pytest.approx(0.160, rel=0.03)


def test_slump(tmp_path):
    # 10 rows. Spread: -0.2 % of the closed form of a shallow layer at arrest, -2.3 % of the same layer with the law's own creep by finite
    # differences; these two differ by 2 %, and neither has more than the first order of the slope. The foremost particle is 1 of 100: a
    # spacing is 4 % of the front
    figures = run_scene(tmp_path, "slump", dx=0.01)
    assert figures["spread"] == pytest.approx(0.2805, rel=0.04)
    assert figures["front"] == pytest.approx(0.2805, rel=0.1)
    assert figures["height_at_wall"] == pytest.approx(0.0535, rel=0.1)
    assert figures["profile_error"] < 0.08
