"""Short form of the sphere in a stream."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import dump, series


def test_levels_around_the_sphere(tmp_path):
    """8 particles across at the sphere, 0.3 D/U: each level is where its distance from the sphere asks for it, nobody is inside of the sphere, and the
    drag is on its way down from the start's 1.5 to 1.1. Without the factor for the quarter it were 0.4."""
    figures = run_scene(tmp_path, "sphere", across=8, width=5, tend=0.3, Re=120)
    assert 1.0 < figures["drag"] < 1.9
    history = series.read(tmp_path / "series.csv")  # of the coefficient
    assert figures["drag"] == pytest.approx(history["drag"][history.time >= 0.8 * history.time[-1]].mean(), rel=1e-6)
    last = dump.read(tmp_path / "particles.dump")[-1]
    water = last["type"] != 2
    from_center = np.sqrt(last["x"]**2 + last["y"]**2 + last["z"]**2)[water] / 0.1
    level, fine = last["type"][water], 1 / 8
    assert set(level) == {1, 3, 4, 5} and from_center.min() > 0.5 - 0.3 * fine
    step = 4.8 * fine / (1 - 2**(-1 / 3))
    for which, near in ((1, 0.6 + step * (2**(2 / 3) - 1)), (3, 0.6 + step * (2**(1 / 3) - 1)), (4, 0.6)):
        # distances are those from the outermost shell, half a spacing inside; who has come in since the last look is coarser still
        assert from_center[level == which].min() > 0.5 - 0.5 * fine + near - 0.1
    assert (level[from_center < 0.9] == 5).all()
