"""Short forms of the blocks in water: five particles over a block's height."""

import json

import pytest

from fsi import scene


def run(tmp_path, **variables):
    """Runs the scene as tools/run does (without building) and returns {figure name: value}."""
    assert scene.run("floating_blocks", tmp_path, 1, {k: str(v) for k, v in variables.items()}) == 0
    return {f["name"]: f["value"] for f in json.loads((tmp_path / "summary.json").read_text())["figures"]}


@pytest.mark.parametrize("ratio", [0.25, 0.75])
def test_block_floats_as_deep_as_archimedes_says(tmp_path, ratio):
    # half a spacing is as well as particles can tell where the surface is
    figures = run(tmp_path, ratio=ratio, dx=0.02, tend=2.0, frames=20)
    assert abs(figures["draft_error"]) < 0.5
    assert figures["draft"] == pytest.approx(100.0 * ratio, abs=10.0)
    assert figures["particles_leaked"] == 0


def test_heavy_block_lies_on_the_floor(tmp_path):
    figures = run(tmp_path, ratio=4, dx=0.02, tend=2.0, frames=20)
    assert abs(figures["gap_to_floor"]) < 0.5
    assert figures["particles_leaked"] == 0
    # it falls more slowly than in a void
    assert 0.1 < figures["fastest_fall"] < 1.98  # [m/s] sqrt(2 g 0.2 m)
