"""Short form of the open channel."""

from scenes import run_scene


def test_cylinder_between_inlet_and_outlet(tmp_path):
    # 8 across at Re = 20, 0.6 to 1.2 s after an impulsive start, whose drag decays to the steady
    # 5.58: a fifth, as in scene cylinder_channel. What
    # flows in is given; what flows out, that and the start's sound. Not one particle is unaccounted
    # for.
    figures = run_scene(tmp_path, "open_channel", across=8, U=0.2, length=0.5, tend=1.2)
    assert 5.0 < figures["drag"] < 6.7
    assert abs(figures["in"] - 1) < 0.02 and abs(figures["out"] - 1) < 0.03
    assert abs(figures["particles"] - 1) < 0.02 and figures["lost"] == 0
