"""The decks of the manual's recipes run, and give what the page says."""

import re
import subprocess
import sys

import numpy as np
import pytest
from scenes import run

from fsi import fill, launch, log, paths

RECIPES = paths.ROOT / "doc/src/recipes"


def go(folder, name, ranks=1, **variables):
    """Runs a recipe as it is, beside copies of all; its log."""
    for path in RECIPES.iterdir():
        if not (folder / path.name).exists():
            (folder / path.name).write_text(path.read_text())
    arguments = [word for key, value in variables.items() for word in ("-var", key, str(value))]
    run(folder, (RECIPES / name).read_text(), ranks, arguments=arguments)
    return log.read(folder / "log.lammps")


def test_every_recipe_is_on_the_page():
    text = (paths.ROOT / "doc/src/Howto_recipes.rst").read_text()
    assert not [path.name for path in RECIPES.iterdir() if f"recipes/{path.name}" not in text]


@pytest.mark.parametrize("name", ["in.bodies", "in.turned", "in.tear", "in.channel", "in.inflow", "in.fine"])
def test_deck(tmp_path, name):
    found = go(tmp_path, name, n=20)
    assert found.finished[-1].steps == 20 and not found.warnings


def test_stl(tmp_path):
    """The cup is read at its place: 28 x 28 x 24 particles less 20 x 20 x 20; the water falls freely before it touches the bottom."""
    fill.main([str(RECIPES / "cup.stl"), "0.01", str(tmp_path / "cup.data"), "--scale", "0.001", "--origin", "-0.04", "-0.04", "-0.04", "--type", "2"])
    found = go(tmp_path, "in.stl", n=100)
    assert found.finished[-1].atoms == 28 * 28 * 24 - 20**3 + 10**3 and not found.warnings
    time, low = found.column("Time"), found.column("v_lowest")
    np.testing.assert_allclose(low, 0.055 - 0.5 * 9.81 * time**2, atol=1e-6)  # printed with eight digits


@pytest.mark.parametrize("extrapolate, dx, value", [("no", 0.01, 1.16), ("yes", 0.01, 0.987), ("no", 0.005, 1.077), ("yes", 0.005, 0.987)])
def test_buoyancy_is_what_the_page_says(tmp_path, extrapolate, dx, value):
    assert go(tmp_path, "in.buoy", extrapolate=extrapolate, dx=dx).values["buoyancy"] == pytest.approx(value, abs=0.005)  # its digits


def test_restart_on_other_ranks(tmp_path):
    """From the same file on one and on two ranks: the same to round-off, before the splash amplifies it."""
    go(tmp_path, "in.first")
    ends = [go(tmp_path, "in.second", ranks, n=200).finished[-1].thermo for ranks in (1, 2)]
    assert ends[0]["Step"][0] == 1000 and ends[0]["Step"][-1] == 1200
    np.testing.assert_allclose(ends[0]["KinEng"], ends[1]["KinEng"], rtol=1e-7)  # eight digits are printed


def test_python_holds_the_velocity(tmp_path):
    """A PI controller whose fastest rate is 10/s, over 1 s: within a tenth of what is wanted."""
    for name in ("in.python", "control.py"):
        (tmp_path / name).write_text((RECIPES / name).read_text())
    done = subprocess.run([sys.executable, "control.py"], cwd=tmp_path, env=launch.environment(), capture_output=True, text=True, check=False)
    speeds = [float(value) for value in re.findall(r"^([\d.]+) m/s", done.stdout, re.M)]
    assert done.returncode == 0 and len(speeds) == 10, done.stdout + done.stderr
    assert speeds[0] < 0.02 and speeds[-1] == pytest.approx(0.1, rel=0.1)
