"""Short form of the bending column: four particles across."""

import pytest
from scenes import run_scene


def test_column_bends_as_finite_elements_do(tmp_path):
    # finite elements: peak 2.99 m, return at 0.910 s. The clamp stands a quarter of a spacing off,
    # 1 % of the length, and the period goes with the square of that; twice this
    figures = run_scene(tmp_path, "bending_column", across=4, tend=1.0)
    assert figures["peak"] == pytest.approx(2.99, rel=0.04)
    assert figures["zero_crossing"] == pytest.approx(0.910, rel=0.04)
    assert figures["energy_error"] < 0.01
