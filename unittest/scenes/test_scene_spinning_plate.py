"""Short forms of the spinning plate."""

import pytest
from scenes import run_scene


@pytest.mark.parametrize("dim", [2, 3])
def test_total_lagrangian_plate_spins_for_ever(tmp_path, dim):
    # forces derive from an energy that rotations leave alone, so angular momentum is kept to
    # round-off
    figures = run_scene(tmp_path, "spinning_plate", dim=dim, across=4, turns=2, frames=40)
    assert figures["angular_momentum_drift"] < 1e-12
    assert figures["energy_drift"] < 1e-4
    # rho (omega L)^2/(8 E) = 0.25 % twofold, for the start is sudden
    assert figures["largest_deformation"] < 0.005
    # the stretched plate turns more slowly
    assert figures["rotation"] == pytest.approx(1.0, abs=0.005)


def test_updated_lagrangian_plate_keeps_most_of_its_spin(tmp_path):
    # artificial stress and corrected gradients cost angular momentum: no more than some per cent in
    # five turns
    figures = run_scene(tmp_path, "spinning_plate", solid="ul", alpha=0.1)
    assert figures["angular_momentum_drift"] < 0.05
    assert figures["largest_deformation"] < 0.02
