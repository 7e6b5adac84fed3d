"""Short form of the twisting column: four particles across."""

import pytest
from scenes import run_scene


def test_column_winds_up_and_unwinds(tmp_path):
    # elastic and without losses: the way back is as long as the way there (to the 10 % that other
    # modes make of it), the column then twists as far the other way, and stays on its axis by
    # symmetry
    figures = run_scene(tmp_path, "twisting_column", across=4, tend=0.32)
    assert 0.5 < figures["largest_twist"] < 1.5
    assert figures["unwound_time"] == pytest.approx(2.0 * figures["largest_twist_time"], rel=0.1)
    assert figures["twist_the_other_way"] == pytest.approx(1.0, abs=0.1)
    assert figures["energy_error"] < 0.01
    assert figures["axis_drift"] < 1e-6
