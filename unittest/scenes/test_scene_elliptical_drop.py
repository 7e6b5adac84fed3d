"""Short form of the elliptical drop."""

from scenes import run_scene


def test_drop_stretches_as_it_should(tmp_path):
    # 20 particles in the radius, to the end: b of the ODE at the last row of the series is 1.94 m,
    # by 1 %; the compressible
    # disc rings by some 0.2 % on the way
    figures = run_scene(tmp_path, "elliptical_drop", dx=0.05)
    assert figures["b_error_worst"] < 0.01
    assert 1.92 < figures["semi_axis_b"] < 1.97
    assert abs(figures["kinetic_energy_drift"]) < 0.01
    # without shifting particles line up and clump
    assert figures["min_pair_distance"] > 0.5
