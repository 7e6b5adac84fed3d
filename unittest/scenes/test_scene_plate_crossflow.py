"""Short form of the plate in cross-flow: one half with its plane of symmetry, and the whole."""

import numpy as np
from scenes import run_scene

from fsi import series


def test_half_is_the_whole(tmp_path):
    """2 particles through the plate, 0.6 s of 8: the plate has begun to bend. Inlet and outlet fit
    quantities over the fluid near a place, without images: one-sided at the plane of symmetry,
    which changes some 1e-5 of the displacement."""
    runs = []
    for half in ("yes", "no"):
        figures = run_scene(tmp_path / half, "plate_crossflow", across=2, tend=0.6, half=half,
                            frames=1)
        assert np.isfinite(figures["ux"])
        runs.append(series.read(tmp_path / half / "series.csv"))
    assert np.array_equal(runs[0].time, runs[1].time)
    assert runs[0]["ux"].max() > 5e-4
    for name in ("ux", "uy", "uz", "fx"):
        assert np.abs(runs[0][name] - runs[1][name]).max() < 1e-4 * np.abs(
            runs[1][name]).max(), name
