"""The study of the elastic gate, on made-up runs: what it says of them follows from their curves."""

import json

import numpy as np
import pytest

from fsi import scene, series

STUDY = scene._analysis("elastic_gate")  # pylint: disable=protected-access


@pytest.fixture
def summary(tmp_path):
    """Two moduli with two resolutions each; the 10 MPa gate is on the experiment's points but for its resolution."""
    experiment = series.read(STUDY.HERE / "experiment.csv")
    for modulus, offset in (("10MPa", 0.0), ("12MPa", 0.02)):
        for across, scale in ((3, 1.1), (5, 1.0)):
            folder = tmp_path / f"{modulus}_{across}"
            folder.mkdir()
            (folder / "log.lammps").write_text(f"FSI dx {0.005 / across}\nFSI across {across}\nFSI rubber gate_{modulus}\n")
            table = np.column_stack([experiment.time, scale * experiment["horizontal"] + offset, experiment["vertical"]])
            np.savetxt(folder / "tip.csv", table, delimiter=",", header="time,tip_x,tip_y", comments="")
            (folder / "snapshots.png").write_text(folder.name)
            (folder / "summary.json").write_text(json.dumps({
                "particles": 10, "ranks": 1, "steps": 1, "wall_seconds": 1.0, "loop_seconds": 1.0, "particle_steps": 10,
                "bytes_per_particle": 1.0, "lammps": "", "figures": [{"name": "particles_leaked", "value": across},
                                                                     {"name": "mass_error", "value": 0.0}]}))
    STUDY.study(tmp_path, {path.name: path for path in sorted(tmp_path.iterdir())})
    return tmp_path, {f["name"]: f for f in json.loads((tmp_path / "summary.json").read_text())["figures"]}


def test_study_is_about_the_finest_run(summary):
    folder, figures = summary
    assert figures["10MPa_rms_x"]["value"] == pytest.approx(0.0, abs=1e-9)
    assert figures["12MPa_rms_x"]["value"] == pytest.approx(20.0)
    assert figures["10MPa_tip_x_peak"]["relative_error"] == pytest.approx(0.0, abs=1e-12)
    assert figures["12MPa_tip_x_peak"]["value"] == pytest.approx(66.4)
    assert (folder / "snapshots.png").read_text() == "10MPa_5"
    assert (folder / "tip.png").stat().st_size > 0 and (folder / "convergence.png").stat().st_size > 0


def test_study_compares_resolutions(summary):
    _, figures = summary
    change = figures["10MPa_tip_x_peak_change_3_to_5_across"]
    assert change["value"] == pytest.approx(1.0 / 1.1 - 1.0) and not change["met"]
    assert figures["10MPa_tip_y_peak_change_3_to_5_across"]["met"]
    assert figures["particles_leaked"]["value"] == 16 and not figures["particles_leaked"]["met"]


def test_no_farther_than_the_nearest_code(summary):
    # distances of the digitised curves of Khayyer et al., Yang et al. and Ng et al. to the experiment's points
    _, figures = summary
    assert figures["10MPa_rms_x"]["met"] and not figures["12MPa_rms_x"]["met"]
    assert figures["10MPa_rms_x"]["target"] == pytest.approx(8.28, abs=0.02)
    assert figures["10MPa_rms_y"]["target"] == pytest.approx(4.60, abs=0.02)
    for text in ("Khayyer et al. 2018 8.3", "Yang et al. 2012 10.7", "Ng et al. 2020 10.9"):
        assert text in figures["10MPa_rms_x"]["source"]
