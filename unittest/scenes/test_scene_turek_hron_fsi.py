"""Short form of the flag behind a cylinder, and the picture of its tip."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import plot, scene, series


def test_flag_in_a_slow_stream(tmp_path):
    # FSI1 from 1.1 to 1.5 s after the water starts with the parabola: the drag, still falling,
    # within 8 % of Featflow's 14.295 N/m, of which the flag has 1.8; its stretch within a quarter
    # of 0.0227 mm, as it is 2 particles across. Sideways it is still on its way to 0.8 mm.
    figures = run_scene(tmp_path, "turek_hron_fsi", benchmark="fsi1", ramp=0, length=0.8, tend=1.5)
    assert abs(figures["drag"] / 14.295 - 1.0) < 0.08
    assert abs(figures["ux"] / 0.0227 - 1.0) < 0.25
    assert abs(figures["uy"]) < 0.8 and abs(figures["lift"]) < 2.0
    assert abs(figures["flow"] - 1.0) < 0.03
    s = series.read(tmp_path / "series.csv")
    assert np.abs(s["uy"]).max() < 0.8e-3 and s.time[-1] > 1.49


@pytest.mark.parametrize("case", ["fsi2", "fsi3"])
def test_tip_is_drawn_in_phase(tmp_path, monkeypatch, case):
    """A swing of the benchmark's mean, amplitude and frequency that begins anywhere, with some
    sound, lies on the benchmark's: to the sound."""
    study, drawn = scene.analysis("turek_hron_fsi"), []
    mean, amplitude, rate = study.REFERENCE[case]["uy"]
    time = np.linspace(0.0, 6.0, 9001)
    tip = (mean + amplitude * np.sin(2.0 * np.pi * rate * (time - 0.1234)) + 0.01 * amplitude
           * np.sin(2.0 * np.pi * 26.0 * time))
    saved = plot.Figure.savefig

    def savefig(figure, *arguments, **options):
        drawn.extend(line.get_ydata() for line in figure.axes[0].lines)
        saved(figure, *arguments, **options)
    monkeypatch.setattr(plot.Figure, "savefig", savefig)
    study.picture_tip(tmp_path / "tip.png",
                      {case: (series.Series({"time": time, "uy": tip}), "1 min")})
    reference, here = drawn
    inside = np.isfinite(here)
    assert inside.mean() > 0.95 and np.ptp(reference) > 1.99 * amplitude
    # a hundredth of a period is 0.06
    assert np.abs(here - reference)[inside].max() < 0.04 * amplitude
