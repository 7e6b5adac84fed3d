"""Short forms of the rolling tank."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import dump, series


def test_free_sloshing(tmp_path):
    """The period of linear theory; 14 particles of depth and waves of two spacings are good for
    some per cent."""
    figures = run_scene(tmp_path, "rolling_tank", baffle="no", motion="pulse", amplitude=2,
                        oil="water_inviscid", slip="yes", dx=0.008, tend=2.6, frames=6)
    assert figures["particles_leaked"] == 0
    k = np.pi / 0.609
    assert figures["sloshing_period"] == pytest.approx(2 * np.pi
                                                       / np.sqrt(9.81 * k * np.tanh(k * 0.1148)),
                                                       rel=0.05)


@pytest.mark.parametrize("coarser, root_rows", [(1, 4 + 1), (2, 8 + 1)])
def test_walls_and_root_turn_and_the_baffle_lags(tmp_path, coarser, root_rows):
    """Tank and root are where the roll puts them, to the six digits of the dump. The tip, which
    nothing has pushed yet, is still where it was: in the frame of the tank it has gone back by roll
    times length; half of it for what root and oil have done by now."""
    figures = run_scene(tmp_path, "rolling_tank", dx=0.002, coarser=coarser, tend=0.06, frames=3,
                        amplitude=40)
    assert figures["particles_leaked"] == 0
    first, last = (dump.read(tmp_path / "particles.dump")[k] for k in (0, -1))
    held = (first["type"] == 3) | ((first["type"] == 2) & (first["y"] < 0.002))
    assert (held & (first["type"] == 2)).sum() == 2 * root_rows
    roll = np.radians(40) * np.sin(0.5 * np.pi * last.time / 0.55)**3
    turned = first.vector("xy") @ np.array([[np.cos(roll), np.sin(roll)],
                                            [-np.sin(roll), np.cos(roll)]])
    assert np.abs(turned - last.vector("xy"))[held].max() < 2e-6 and np.abs(
        turned - first.vector("xy")).max() > 1e-3
    history = series.read(tmp_path / "tank.csv")
    assert history["tip"][-1] / (0.1148 * np.radians(history["roll"][-1])) == pytest.approx(
        1.0, abs=0.5)
