"""Short form of the damping study, whose deck is a link to that of the oscillating plate."""

from scenes import run_scene


def test_disorder_damps_and_viscosity_remedies_it(tmp_path):
    # The paper's finding, which holds without artificial stress on a coarse plate: less damping
    # with more viscosity. And the ledger: an elastic plate is not damped (finite elements: under
    # 0.1 % in 12 periods), so what the particles lose is what viscosity takes, to 5 % for the work
    # of the density of mode `ratio`, which the ledger does not follow.
    swings = {alpha: run_scene(tmp_path / str(alpha), "plate_damping", n=5, mode="paper", eps=0,
                               periods=6.5, alpha=alpha, ledger="yes")
              for alpha in (0.01, 0.1)}
    assert swings[0.1]["a5_a1"] > swings[0.01]["a5_a1"] + 0.3
    for figures in swings.values():
        assert figures["taken_by_viscosity"] > 0.0
        assert abs(figures["mechanical_energy"] + figures["taken_by_viscosity"] - 1.0) < 0.05


def test_total_lagrangian_plate_is_damped_by_viscosity_only(tmp_path):
    # without viscosity there is nothing to damp it; with it the loss is what the ledger books as
    # viscous
    swings = {alpha: run_scene(tmp_path / str(alpha), "plate_damping", n=4, alpha=alpha,
                               ledger="yes") for alpha in (0, 1)}
    assert abs(swings[0]["a5_a1"] - 1.0) < 5e-3
    assert swings[1]["a5_a1"] < swings[0]["a5_a1"]
    for figures in swings.values():
        assert abs(figures["mechanical_energy"] + figures["taken_by_viscosity"] - 1.0) < 1e-3
