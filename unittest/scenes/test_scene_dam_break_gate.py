"""The dam break behind a lifting gate: what it is judged by, on plates and water made for it, and
short forms."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import dump, scene, series

ANALYSIS = scene.analysis("dam_break_gate")


def frame(water, lean=0.0):
    """A plate 4 by 40 particles high that leans by `lean` times the height, its middle at x = 2,
    and water."""
    y, x = (grid.ravel()
            for grid in np.meshgrid(np.arange(40) + 0.5, np.arange(4) - 1.5, indexing="ij"))
    place = np.vstack([np.column_stack([x + 2.0 + lean * y, y]), water])
    kind = np.array([2] * len(x) + [1] * len(water))
    return dump.Frame(0, 0.0, None, {"id": np.arange(len(kind)), "type": kind, "x": place[:, 0],
                                     "y": place[:, 1]})


ROWS = np.repeat(np.arange(40), 4)


@pytest.mark.parametrize("lean", [0.0, 0.75])
def test_water_beside_the_plate(lean):
    """Its distance along the normal of a plate that leans; nearest to the upper end or above it
    there is none."""
    along = np.array([lean, 1.0]) / np.hypot(lean, 1.0)
    normal, foot = np.array([-along[1], along[0]]), np.array([2.0 + 10.5 * lean, 10.5])
    water = [foot + 3.0 * normal, foot - 3.0 * normal, foot + 0.5 * normal,
             foot + 0.2 * along - 1.0 * normal, (2.0 + 39.5 * lean, 39.4), (-9.0, 50.0)]
    distance, row = ANALYSIS.beside(frame(np.array(water), lean), ROWS)
    np.testing.assert_allclose(distance, [3.0, -3.0, 0.5, -1.0, np.nan, np.nan], rtol=1e-12)
    assert row[:4].tolist() == [10, 10, 10, 10]


def test_touch():
    """The front's face, half a spacing ahead of its particle, moves by 1 m/s from 0 and meets the
    plate at 0.625 s, between two rows."""
    time = np.linspace(0.0, 1.0, 11)
    plate = series.Series({"time": time, "front": time - 0.05})
    assert ANALYSIS.touch(plate, {"wx": 0.1, "face": 0.625}) == pytest.approx(0.625, rel=1e-12)
    assert ANALYSIS.touch(plate, {"wx": 0.1, "face": 1.5}) is None


LIGHT = {"plate": "obstacle_1MPa"}  # a plate that takes few sub-steps: no water reaches it here


def test_gate_holds_and_lifts(tmp_path):
    """Shut, it carries rho g H^2/2 to 3 % and nothing goes below it. Lifted, its edge is where the
    fit to the measured gate is, to the six digits of the dump, and rests from 0.17 s on; the front
    is behind that of a dam that breaks at once."""
    shut = run_scene(tmp_path / "shut", "dam_break_gate", gate="shut", tend=0.1, frames=2, **LIGHT)
    held = series.read(tmp_path / "shut" / "plate.csv")
    assert np.mean(held["held"][held.time > 0.05]) == pytest.approx(0.5 * 9810 * 0.2**2, rel=0.03)
    assert held["front"].max() < 0.2 and held["m3"].max() < 1e-6 and shut["particles_leaked"] == 0
    fronts = {}
    for gate in ("lifted", "none"):
        figures = run_scene(tmp_path / gate, "dam_break_gate", gate=gate, tend=0.18, frames=8,
                            **LIGHT)
        assert figures["particles_leaked"] == 0 and figures["energy_error"] < 0.01
        fronts[gate] = series.read(tmp_path / gate / "plate.csv")["front"][-1]
    assert 0.02 < fronts["none"] - fronts["lifted"] < 0.1
    for shot in dump.read(tmp_path / "lifted" / "particles.dump"):
        t = min(shot.time, 0.17)
        edge = shot.of_types(ANALYSIS.GATE)["y"].min() - 0.002
        assert edge == pytest.approx(-285.115 * t**3 + 72.305 * t**2 + 0.1463 * t, abs=2e-6)
    assert edge == pytest.approx(0.7137, abs=1e-4)
