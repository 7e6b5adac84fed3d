"""Short forms of the scenes of rigid bodies that water moves: settling_disc, cylinder_entry,
sinking_square."""

import pytest
from scenes import run_scene


def test_settling_disc(tmp_path):
    # 8 particles per diameter: -5.2 % here, -6.4 and -6.5 % with 10 and 16 (finite elements of
    # Glowinski et al. 2001)
    figures = run_scene(tmp_path, "settling_disc", across=8, tend=0.12)
    assert figures["speed_at_0.1_s"] == pytest.approx(42.76, rel=0.08)


def test_cylinder_entry(tmp_path):
    # experiment of Greenhow and Lin (1983): -3.3 and +4.9 %; its own points lie 0.06 D off a smooth
    # curve
    figures = run_scene(tmp_path, "cylinder_entry")
    assert figures["depth_at_0.80"] == pytest.approx(1.068, rel=0.05)
    assert figures["depth_at_1.13"] == pytest.approx(1.220, rel=0.06)
    assert figures["apart_from_experiment"] < 0.08


def test_sinking_square(tmp_path):
    # 10 particles along a side, experiment in Qiu, Liu and Han (2017): +0.3 %, with 20 -4.6 %
    figures = run_scene(tmp_path, "sinking_square", dx=0.002)
    assert figures["time_from_120_to_40_mm"] == pytest.approx(0.2161, rel=0.06)
