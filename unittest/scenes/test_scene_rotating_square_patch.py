"""Short form of the rotating square patch."""

from scenes import run_scene


def test_patch_keeps_together(tmp_path):
    # 25 particles across, one radian. The center's pressure at the start is that of the Fourier
    # series; the patch stays whole,
    # and its arms alike, only with shifting
    figures = run_scene(tmp_path / "shift", "rotating_square_patch", dx=0.04, tend=1.0, jitter=0.1)
    assert abs(figures["centre_pressure"] / -0.1473 - 1.0) < 0.05
    assert figures["voids"] == 0
    assert figures["arm_asymmetry"] < 0.05
    assert abs(figures["angular_momentum_drift"]) < 0.02
    plain = run_scene(tmp_path / "plain", "rotating_square_patch", dx=0.04, tend=1.0, jitter=0.1,
                      shift=0)
    assert plain["voids"] > 10
