"""Short form of the cylinder in a channel."""

import math
import re
import subprocess

import pytest
from fsi import launch, scene
from scenes import run_scene


def test_cylinder_in_a_channel(tmp_path):
    # 8 across, 0.9 to 1.2 s after an impulsive start, whose drag decays to the steady 5.58: a
    # fifth. A lower wall that slips brings it to 4.9 and
    # less in the steady state. A mean lift of a tenth of the drag would be a cylinder that is not
    # round.
    figures = run_scene(tmp_path, "cylinder_channel", across=8, length=0.5, tend=1.2)
    assert 5.0 < figures["drag"] < 6.7
    assert abs(figures["lift"]) < 0.5


@pytest.mark.parametrize("name", ["cylinder_channel", "open_channel"])
def test_a_coarse_cylinder_has_its_area(tmp_path, name):
    # four across a channel of 16 rows of 0.41/16 m
    command = launch.lammps(scene.deck(name), 0, {"across": 4, "length": 0.5, "tend": 0.002})
    done = subprocess.run(command, cwd=tmp_path, env=launch.environment(), capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stdout[-500:]
    found = re.search(r"region cylinder encloses (\S+), in (\d+) particles", done.stdout)
    assert float(found[1]) == pytest.approx(math.pi * 0.05**2, rel=2e-3) and int(found[2]) == round(
        math.pi * 0.05**2 / (0.41 / 16) ** 2)
