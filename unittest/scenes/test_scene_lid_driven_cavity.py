"""Short form of the lid-driven cavity, judged by Ghia, Ghia and Shin's multigrid solution."""

from scenes import run_scene


def test_cavity_at_re_100(tmp_path):
    # The scene's target, 2 % of the lid's speed, at a fifth of the particles of its finest case:
    # the flow is steady after 8 L/U. A side wall that slips is 3 % off and more, a lid that does
    # not move 20 %. Nothing passes a wall.
    figures = run_scene(tmp_path, "lid_driven_cavity", n=20, tend=12)
    assert figures["rms"] < 0.02
    assert (tmp_path / "log.lammps").read_text().count("WARNING") == 0
