"""Short forms of the blocks in water: five particles over a block's height."""

import pytest
from scenes import run_scene


@pytest.mark.parametrize("ratio", [0.25, 0.75])
def test_block_floats_as_deep_as_archimedes_says(tmp_path, ratio):
    # half a spacing is as well as particles can tell where the surface is
    figures = run_scene(tmp_path, "floating_blocks", ratio=ratio, dx=0.02, tend=2.0, frames=20)
    assert abs(figures["draft_error"]) < 0.5
    assert figures["draft"] == pytest.approx(100.0 * ratio, abs=10.0)
    assert figures["particles_leaked"] == 0


@pytest.mark.parametrize("ratio", [0.5, 4])
def test_block_twice_as_coarse_as_the_water(tmp_path, ratio):
    """As one of the water's spacing"""
    figures = run_scene(tmp_path, "floating_blocks", ratio=ratio, dx=0.0125, block_dx=0.025,
                        tend=2.0, frames=20)
    assert abs(figures["draft_error" if ratio < 1 else "gap_to_floor"]) < 0.5
    assert figures["particles_leaked"] == 0


def test_heavy_block_lies_on_the_floor(tmp_path):
    figures = run_scene(tmp_path, "floating_blocks", ratio=4, dx=0.02, tend=2.0, frames=20)
    assert abs(figures["gap_to_floor"]) < 0.5
    assert figures["particles_leaked"] == 0
    # it falls more slowly than in a void
    assert 0.1 < figures["fastest_fall"] < 1.98  # [m/s] sqrt(2 g 0.2 m)
