"""Short form of the cylinder in a free stream."""

from scenes import run_scene


def test_cylinder_in_a_stream_sheds_vortices(tmp_path):
    # 8 across, 10 D of width, 40 D/U; drag and Strouhal number of finite elements in the same box
    # (box.edp): 1.468 and 0.1766. 6 % and 5 %
    # leave room for the resolution (measured -3.7 and +2.6 %). The lift, of 0.260, has still to
    # grow and to be better resolved: at this time it is 0.212 on one rank. A wake that is even has
    # below 0.1 of it.
    figures = run_scene(tmp_path, "cylinder_free", across=8, width=10, upstream=5, downstream=6,
                        tend=40)
    assert abs(figures["drag"] / 1.468 - 1) < 0.06
    assert abs(figures["strouhal"] / 0.1766 - 1) < 0.05
    assert 0.21 < figures["lift"] < 0.28
    # what the zone gives to the stream is what the cylinder takes, but for what shifting does not
    # keep
    assert abs(figures["push"] / figures["drag"] - 1) < 0.12
