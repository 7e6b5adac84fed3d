"""What the valve is judged by, on frames and flows made for it, and a short form of the scene."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import dump, scene, series

ANALYSIS = scene.analysis("valve")
VALUES = {"sx": 0.25, "wx": 1.0}


def frame(water, apart):
    """Two leaflets of 4 x 20 particles, `apart` between their nearest rows, and a particle of
    water."""
    x, y = (grid.ravel() for grid in np.meshgrid(0.25 * np.arange(20) + 5.0, 0.25 * np.arange(4)))
    place = np.vstack([np.column_stack([x, y]), np.column_stack([x, y + 0.75 + apart]), [water]])
    count = len(x)
    columns = {"x": place[:, 0], "y": place[:, 1], "type": np.array([2] * 2 * count + [1]),
               "mol": np.array([1] * count + [2] * count + [0])}
    return dump.Frame(0, 0.0, None, columns)


@pytest.mark.parametrize("water, inside, distance", [
    # in the middle of a cell of the leaflet, its farthest place from particles
    ((6.125, 0.375), 1, 0.5**0.5),
    ((6.0, 0.375), 1, 0.5),
    ((6.0, -0.625), 0, 2.5),  # half of both spacings from the face's row
    ((4.0, 0.0), 0, 4.0)])
def test_water_in_leaflets(water, inside, distance):
    found = ANALYSIS.distances(frame(np.array(water) * (1 - 1e-12), 0.5), VALUES)
    assert found == (inside, pytest.approx(distance, rel=1e-9), pytest.approx(2.0, rel=1e-9))


def test_nearest_in_parts(monkeypatch):
    """Against a tree of all pairs done at once."""
    points, others = np.random.default_rng(1).random((2, 1500, 2))
    expected = np.array([np.hypot(*(others - p).T).min() for p in points])
    assert ANALYSIS.nearest(points, others) == pytest.approx(expected, rel=1e-12)


def test_pulses():
    """q = sin(2 pi t) + 0.2 about its zeros: volumes are integrals between them."""
    time = np.linspace(0.0, 2.0, 20001)
    q, opening = np.sin(2.0 * np.pi * time) + 0.2, 3.0 - np.cos(2.0 * np.pi * time)
    valve = series.Series({"time": time, "q": q, "lowy": -0.5 * opening, "highy": 0.5 * opening})
    zero = np.arcsin(0.2) / (2.0 * np.pi)  # flow ends at 0.5 + zero and begins at 1 - zero

    def volume(a, b):
        return (np.cos(2.0 * np.pi * a) - np.cos(2.0 * np.pi * b)) / (2.0 * np.pi) + 0.2 * (b - a)

    (first, second), passed = ANALYSIS.pulses(valve, 1.0)
    back = -volume(0.5 + zero, 1.0 - zero)
    assert first == pytest.approx((volume(0.0, 0.5 + zero), back, 4.0, 2.0), abs=1e-6)
    assert second == pytest.approx((volume(1.0 - zero, 1.5 + zero), back, 4.0, 2.0), abs=1e-6)
    assert passed[-1] == pytest.approx(0.4, abs=1e-6)


def test_opens(tmp_path):
    """The flow is below that of the water's inertia alone, the integral of P H/(rho X), of which
    the valve leaves more than half, once sound has gone through the channel (0.03 s). Nothing
    enters the leaflets."""
    figures = run_scene(tmp_path, "valve", tend=0.06)
    valve = series.read(tmp_path / "valve.csv")
    late = valve.time > 0.04
    bound = 100.0 * 0.02 / (1000.0 * 0.16) * 0.4 / (2.0 * np.pi) * (
        1.0 - np.cos(2.0 * np.pi * valve.time[late] / 0.4))
    share = valve["q"][late] / bound
    assert 0.5 < share.min() and share.max() < 1.0
    opening = valve["highy"] - valve["lowy"]
    # at rest 20 - 12 sin 50 - 13 sin 45 degrees [mm], to the middle of the last column
    assert opening[-1] > opening[0] > 1.6e-3
    assert figures["water_in_leaflets"] == 0 and figures["nearest_water"] > 1.0
