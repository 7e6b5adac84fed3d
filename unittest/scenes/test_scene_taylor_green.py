"""Short form of the Taylor-Green vortices."""

from scenes import run_scene


def test_taylor_green_decays_as_it_should(tmp_path):
    # 25 particles across, half a turn-over time: the exact solution, 3 % of the speed in the mean
    # as the scene's own target and
    # 3 % of the decay rate, of which 1 % is the viscosity's 0.01 h^2
    figures = run_scene(tmp_path / "shift", "taylor_green", dx=0.04, tend=0.5)
    assert figures["l1_velocity"] < 0.03
    assert abs(figures["energy_decay_rate"] / 1.5791 - 1.0) < 0.03
    # what it is measured against: without shifting the lattice breaks up
    plain = run_scene(tmp_path / "plain", "taylor_green", dx=0.04, tend=0.5, shift=0, jitter=0)
    assert plain["l1_velocity"] > 0.2
