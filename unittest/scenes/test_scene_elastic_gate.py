"""The study of the elastic gate, on made-up runs: what it says of them follows from their
curves."""

import json

import numpy as np
import pytest

from fsi import dump, scene, series
from fsi.log import Log, Run

STUDY = scene.analysis("elastic_gate")


def write_run(folder, tip, values, leaked=0, outflow=0):
    """What a run and its analysis leave. tip: [time, x, y], values: what the deck prints."""
    folder.mkdir()
    (folder / "log.lammps").write_text(
        "".join(f"FSI {name} {value}\n" for name, value in values.items()))
    np.savetxt(folder / "tip.csv", np.column_stack(tip), delimiter=",", header="time,tip_x,tip_y",
               comments="")
    (folder / "snapshots.png").write_text(folder.name)
    figures = [{"name": "particles_leaked", "value": leaked},
               {"name": "outflow_particles", "value": outflow},
               {"name": "mass_error", "value": 0.0}]
    (folder / "summary.json").write_text(json.dumps({
        "particles": 10, "ranks": 1, "steps": 1, "cpu_seconds": 1.0, "loop_seconds": 1.0,
        "particle_steps": 10,
        "bytes_per_particle": 1.0, "lammps": "", "figures": figures}))


@pytest.fixture
def summary(tmp_path):
    """Two moduli with two resolutions each, one of these with another solid, and a long run; the 10
    MPa gate is on the experiment's points but for its resolution."""
    experiment = series.read(STUDY.HERE / "experiment.csv")
    for modulus, offset in (("10MPa", 0.0), ("12MPa", 0.02)):
        for across, scale, solid in ((3, 1.1, "tl"), (5, 1.0, "tl"), (3, 1.65, "ul")):
            if solid == "tl" or modulus == "12MPa":
                write_run(tmp_path / f"{modulus}_{across}_{solid}",
                          [experiment.time, scale * (experiment["horizontal"] + offset),
                           experiment["vertical"]],
                          {"dx": 0.005 / across, "across": across, "rubber": f"gate_{modulus}",
                           "solid": solid}, across)
    write_run(tmp_path / "12MPa_5_coarse",
              [experiment.time, 1.01 * (experiment["horizontal"] + 0.02), experiment["vertical"]],
              {"dx": 0.001, "across": 5, "coarser": 2.5, "rubber": "gate_12MPa", "solid": "tl"})
    times = np.linspace(0.0, 4.0, 41)
    write_run(tmp_path / "long", [times, np.where(times > 3.0, 0.001, 1.0), 0.0 * times],
              {"dx": 0.0025, "across": 2, "rubber": "gate_10MPa", "solid": "tl"}, 0, 7)
    (tmp_path / "long" / "particles.dump").write_text(frame(4.0, [(1, 0.5, 0.01, 3.0)]))
    STUDY.study(tmp_path, {path.name: path for path in sorted(tmp_path.iterdir())})
    return tmp_path, {f["name"]: f
                      for f in json.loads((tmp_path / "summary.json").read_text())["figures"]}


def test_coarser_water_is_beside_the_gate_of_one_spacing(summary):
    _, figures = summary
    peak = figures["12MPa_water_2.5_times_coarser_tip_x_peak"]
    assert peak["relative_error"] == pytest.approx(0.01) and peak["target"] == 0.02
    assert figures["12MPa_water_2.5_times_coarser_tip_y_rms"]["value"] == pytest.approx(
        0.0, abs=1e-9)


def frame(time, water, gate=()):
    """A frame of a dump. water: [(id, x, y, vx)]; gate: [(id, x, y)]."""
    rows = [f"{i} 1 {x} {y} {vx} 0 {1000 + i}"
            for i, x, y, vx in water] + [f"{i} 2 {x} {y} 0 0 1100" for i, x, y in gate]
    return "\n".join([f"ITEM: TIME\n{time}\nITEM: TIMESTEP\n{time * 1000:.0f}\n"
                      f"ITEM: NUMBER OF ATOMS\n{len(rows)}",
                      "ITEM: BOX BOUNDS ff ff pp\n-0.01 1\n-0.01 0.3\n-0.001 0.001",
                      "ITEM: ATOMS id type x y vx vy rho", *rows, ""])


def test_study_is_about_the_finest_run(summary):
    folder, figures = summary
    assert figures["10MPa_rms_x"]["value"] == pytest.approx(0.0, abs=1e-9)
    assert figures["12MPa_rms_x"]["value"] == pytest.approx(20.0)
    assert figures["12MPa_tip_x_peak_in_codes"]["reference"] == pytest.approx(0.5 * (39.0 + 42.7))
    assert figures["10MPa_tip_x_peak"]["relative_error"] == pytest.approx(0.0, abs=1e-12)
    assert figures["12MPa_tip_x_peak"]["value"] == pytest.approx(66.4)
    assert (folder / "snapshots.png").read_text() == "10MPa_5_tl"
    assert (folder / "tip.png").stat().st_size > 0 and (folder
                                                        / "convergence.png").stat().st_size > 0


def test_study_compares_resolutions(summary):
    _, figures = summary
    change = figures["10MPa_tip_x_peak_change_3_to_5_across"]
    assert change["value"] == pytest.approx(1.0 / 1.1 - 1.0) and not change["met"]
    assert figures["10MPa_tip_y_peak_change_3_to_5_across"]["met"]
    assert figures["particles_leaked"]["value"] == 19 and not figures["particles_leaked"]["met"]


def test_no_farther_than_the_nearest_code(summary):
    # distances of the digitized curves of Khayyer et al., Yang et al. and Ng et al. to the
    # experiment's points
    _, figures = summary
    assert figures["10MPa_rms_x"]["met"] and not figures["12MPa_rms_x"]["met"]
    assert figures["10MPa_rms_x"]["target"] == pytest.approx(8.28, abs=0.02)
    assert figures["10MPa_rms_y"]["target"] == pytest.approx(4.60, abs=0.02)
    for text in ("Khayyer et al. 2018 8.3", "Yang et al. 2012 10.7", "Ng et al. 2020 10.9"):
        assert text in figures["10MPa_rms_x"]["source"]


def test_other_solids_stand_beside(summary):
    _, figures = summary
    other = figures["12MPa_ul_tip_x_peak_3_across"]
    assert other["relative_error"] == pytest.approx(0.5) and other["target"] is None


def test_long_run_is_about_its_end(summary):
    _, figures = summary
    assert figures["long_outflow_particles"]["value"] == 7
    assert figures["long_tip_x_end"]["value"] == pytest.approx(1.0)
    assert figures["long_water_speed_end"]["value"] == pytest.approx(3.0)


def test_only_what_leaves_at_the_far_end_is_outflow(tmp_path):
    # Particles 1 to 3 are lost between two frames: at the far end, on its way upwards near it, and
    # at the gate.
    gate = [(10 + 2 * k + n, 0.1 + 0.004 * n, 0.003 * k) for k in range(30) for n in range(2)]
    (tmp_path / "particles.dump").write_text(
        frame(0.0, [(1, 0.98, 0.01, 2.0), (2, 0.98, 0.2, 0.0), (3, 0.09, 0.01, 0.0),
                    (4, 0.5, 0.01, 1.0)], gate) +
        frame(0.01, [(4, 0.51, 0.01, 1.0)], gate))
    run = Log(runs=[Run(thermo={"Atoms": np.array([64, 61]), "v_mass": np.array([1.0, 1.0])})],
              values={}, warnings=[], errors=[])
    frames = dump.read(tmp_path / "particles.dump")
    assert STUDY.count_leaks(frames, 0.001, run) == (2, [1])
    # a particle's mass is as its share of the densities of the four of water
    run.runs[0].thermo["v_mass"] = np.array([20.0, 20.0 * (1.0 - 1001.0 / 4010.0)])
    assert STUDY.mass_error(run, frames[0], frames[1], [1]) == pytest.approx(0.0, abs=1e-12)
