"""Short forms of the bundled scenes, judged by the figures of their own analysis."""

import subprocess

import numpy as np
import pytest
from scenes import run_scene

from fsi import launch, scene, series


def test_elastic_gate_swings_as_it_should(tmp_path):
    # Three particles across, beyond the first peak. Finite elements bend this gate by 34.81 mm and
    # 9.50 mm under the whole reservoir's static load (scene gate_static); the three published codes
    # (CODE_PEAKS of the analysis) peak at 39.0 to 42.7 mm and 13.1 to 14.8 mm after 0.115 to 0.120
    # s: a falling head on a gate with inertia bends it farther than that head at rest. The lower
    # bounds leave
    # 3 % and 6 % for three particles across, as in gate_static.
    figures = run_scene(tmp_path, "elastic_gate", dx=0.005 / 3, tend=0.13)
    assert 0.97 * 34.81 < figures["tip_x_peak"] < 42.7
    assert 0.94 * 9.50 < figures["tip_y_peak"] < 14.8
    assert 0.09 < figures["tip_x_peak_time"] < 0.125
    assert figures["particles_leaked"] == figures["outflow_particles"] == 0
    assert figures["mass_error"] == 0.0


def test_elastic_gate_does_not_depend_on_ranks(tmp_path):
    # the flow is chaotic, so round-off grows, but the tip's curve must not show it: 1 % of its
    # largest value
    for n in (1, 2):
        run_scene(tmp_path / str(n), "elastic_gate", dx=0.0025, tend=0.06, ranks=n)
    a, b = (series.read(tmp_path / str(n) / "tip.csv") for n in (1, 2))
    np.testing.assert_allclose(a["time"], b["time"])
    assert np.max(np.abs(a["tip_x"] - b["tip_x"])) < 0.01 * a["tip_x"].max()


def test_still_water_stays_still(tmp_path):
    # hydrostatic pressure is exact; 1.5 % and 1e-5 are the package's own bounds for two seconds at
    # 25 particles depth. Pairing would show as a distance far below the spacing.
    figures = run_scene(tmp_path, "still_water", tend=2)
    assert figures["pressure_l2"] < 0.015
    assert figures["ke_over_pe"] < 1.0e-5
    assert figures["min_pair_distance"] > 0.9
    assert figures["particles_leaked"] == 0
    # Archimedes: the floor carries the weight of the water, to 1 % once averaged over the second
    # half
    s = series.read(tmp_path / "series.csv")
    assert abs(np.mean(s["weight"][len(s["weight"]) // 2:]) - 1.0) < 0.01


def test_still_water_never_wakes(tmp_path):
    # Where a lattice is soft under pressure, round-off grows: with the quintic and h = dx the
    # kinetic energy is 1e-6 of the potential one after 13.7 s (fsi_kernel.h). The deck's kernel
    # leaves what the start gave, 2e-9 after 2 s, which decays.
    run_scene(tmp_path, "still_water", dx=0.05, tend=18, cfl=1.0, frames=2)
    history = series.read(tmp_path / "series.csv")
    assert np.max((history["ke"] / history["pe"])[history.time > 2]) < 1e-8
    assert history["reflected"][-1] == 0


@pytest.mark.parametrize("name, given", [("elastic_gate", {"coarser": 3}),
                                         ("hydrostatic_plate", {"coarser": 3}),
                                         ("submerged_plate", {"across": 3, "coarser": 2}),
                                         ("rolling_tank", {"dx": 0.001, "coarser": 3}),
                                         ("turek_hron_fsi", {"across": 3})])
def test_water_that_does_not_fit_is_refused(tmp_path, name, given):
    """The plate under water ran with coarser=3 once, its pressure 16 % off."""
    run = subprocess.run(launch.lammps(scene.deck(name), 1, given), cwd=tmp_path,
                         env=launch.environment(), capture_output=True, text=True, timeout=60)
    assert (run.returncode == 1 and f"ERROR: {list(given)[-1]}=" in run.stdout
            and "does not divide" in run.stdout)
