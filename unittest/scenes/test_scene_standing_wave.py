"""Short form of the standing wave."""

from scenes import run_scene


def test_standing_wave_has_the_period_of_linear_theory(tmp_path):
    # 12 particles deep, 1.5 periods. omega^2 = g k tanh kd; the second-order correction at this
    # amplitude is 0.04 %
    figures = run_scene(tmp_path, "standing_wave", dx=0.04, periods=1.5)
    assert abs(figures["period"] / 1.18181 - 1.0) < 0.01
    assert figures["particles_leaked"] == 0
    # 4 nu k^2 = 0.079/s, and what the coarse scheme adds; a tenth of a wave of energy at most, and
    # no gain
    assert 0.05 < figures["energy_decay_rate"] < 0.2
