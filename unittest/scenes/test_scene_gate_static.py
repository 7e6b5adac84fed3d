"""Short form of the gate under a static load."""

import pytest
from scenes import run_scene

from fsi import series


@pytest.fixture(scope="module")
def gate(tmp_path_factory):
    """Three particles across, the load still rising at the end of the run: figures and the tip over
    time."""
    folder = tmp_path_factory.mktemp("gate_static")
    return run_scene(folder, "gate_static", dx=0.0016666666667,
                     tend=0.2), series.read(folder / "tip.csv")


def test_load_is_that_of_the_water(gate):
    # as long as the gate is straight: the integral of 9810 (0.14 - y) over 46 rows of 1.667 mm, and
    # nothing upwards. At 0.0025 s the free end is off by 0.01 mm, so that the load is right to
    # 1e-3.
    _, tip = gate
    length = 46 * 0.005 / 3
    k = 2
    assert 0.001 < tip.time[k] < 0.003 and tip["tip_x"][k] < 2e-5
    assert tip["load_x"][k] == pytest.approx(tip.time[k] / 0.05 * 9810.0
                                             * (0.14 * length - 0.5 * length**2), rel=1e-3)
    assert abs(tip["load_y"][k]) < 1e-3 * tip["load_x"][k]


def test_gate_comes_to_rest_bent_by_the_load(gate):
    # finite elements: 34.81 mm and 9.50 mm. Free rows and effective clamp make a gate of 78.33 mm
    # for 79 mm, and a beam's deflection under this load goes with the power 3.8 of its length: -3.2
    # %. Twice that for the vertical displacement, which goes with the square of the horizontal one.
    # Around these 2 %, and 4 %, for three particles across.
    figures, _ = gate
    assert figures["effective_length"] == pytest.approx(78.33, abs=0.01)
    assert figures["tip_x"] == pytest.approx((1.0 - 0.032) * 34.81, rel=0.02)
    assert figures["tip_y"] == pytest.approx((1.0 - 0.064) * 9.50, rel=0.04)
    assert figures["still_moving"] < 1e-3
