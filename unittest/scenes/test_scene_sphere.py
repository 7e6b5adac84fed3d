"""Short forms of the sphere in a stream, and what its analysis makes of vortices."""

import numpy as np
import pytest
from scenes import run_scene

from fsi import dump, scene, series

ANALYSIS = scene.analysis("sphere")


def test_levels_around_the_sphere(tmp_path):
    """8 particles across at the sphere, 0.5 D/U: each level is where its distance from the sphere
    asks for it, nobody is among its particles, and the drag, in the mean over the sound of the
    sudden start, is that of 1.2 at which it arrives. Without the factor for the quarter it were
    0.4."""
    figures = run_scene(tmp_path, "sphere", across=8, width=5, tend=0.5, Re=120)
    history = series.read(tmp_path / "series.csv")  # of the coefficient
    assert 0.9 < history["drag"].mean() < 1.6
    assert figures["drag"] == pytest.approx(
        history["drag"][history.time >= 0.8 * history.time[-1]].mean(), rel=1e-6)
    last = dump.read(tmp_path / "particles.dump")[-1]
    water = last["type"] != 2
    from_center = np.sqrt(last["x"]**2 + last["y"]**2 + last["z"]**2)[water] / 0.1
    level, fine = last["type"][water], 1 / 8
    assert set(level) == {1, 3, 4, 5} and from_center.min() > 0.5 - 0.5 * fine
    step = 4.8 * fine / (1 - 2**(-1 / 3))
    for which, near in ((1, 0.6 + step * (2**(2 / 3) - 1)), (3, 0.6 + step * (2**(1 / 3) - 1)),
                        (4, 0.6)):
        # who has come in since the last look is coarser still
        assert from_center[level == which].min() > 0.5 + near - 0.1
    assert (level[from_center < 0.9] == 5).all()


def test_half_and_quarter_are_one_sphere(tmp_path):
    """Drag of the half, which a kick along y has started, is that of the quarter to 4 %: water is
    packed on both sides, five across. With the quarter's factor it were twice as large. Lift is
    small, where the quarter's is the pressure on its plane of symmetry."""
    drags = {}
    for part, kick in (("quarter", 0), ("half", 0.3)):
        folder = tmp_path / part
        folder.mkdir()
        run_scene(folder, "sphere", across=5, levels=0, width=4, upstream=2, downstream=2, tend=0.5,
                  part=part, kick=kick)
        s = series.read(folder / "series.csv")
        drags[part] = s["drag"][s.time > 0.02].mean()
    assert drags["half"] == pytest.approx(drags["quarter"], rel=0.08)
    assert abs(s["lift"][s.time > 0.02].mean()) < 0.1
    first = dump.read(folder / "particles.dump")[0]
    # what an open end has made comes as its command says
    water = first.select((first["type"] != 2) & (abs(first["x"]) < 0.18))
    x, y, z = (water[c] / 0.1 for c in "xyz")
    assert y.min() < -1.8 and z.min() > 0
    potential = -1.5 * 0.5**3 * x * y / (x**2 + y**2 + z**2)**2.5
    # as many digits has the file
    assert water["vy"] == pytest.approx(potential + 0.3 * np.exp(-(x - 1)**2 - y**2 - z**2),
                                        abs=1e-5)


@pytest.mark.parametrize("part, share", [("quarter", 4), ("half", 2), ("whole", 1)])
def test_sphere_has_its_volume_before_the_planes(tmp_path, part, share):
    figures = run_scene(tmp_path, "sphere", across=8, levels=0, width=2, upstream=1.5,
                        downstream=1.5, tend=0.1, part=part)
    assert np.isfinite(figures["drag"])
    sphere = dump.read(tmp_path / "particles.dump")[-1]
    sphere = sphere.select(sphere["type"] == 2)
    before = (sphere["y"] > (0 if part == "quarter" else -1)) & (sphere["z"]
                                                                 > (-1 if part == "whole" else 0))
    assert before.sum() == round(np.pi / 6 * 8**3 / share)
    assert np.sqrt(sphere["x"]**2 + sphere["y"]**2 + sphere["z"]**2)[before].max() == pytest.approx(
        0.05 * (1 - 1 / 8), rel=1e-3)


def test_figures_of_vortices(tmp_path):
    """Johnson and Patel's sphere with the sound of events on top: figures of the last two
    thirds."""
    time = np.arange(0, 60, 0.03)
    early = time < 19
    drag = np.where(early, 2.0, 0.656) + 0.1 * np.sin(40 * time)
    lift = np.where(early, 1.0, 0.069) + 0.016 * np.sin(2 * np.pi * 0.137
                                                        * time) + 0.05 * np.sin(40 * time)
    table = np.column_stack([time * 0.1 / 3, drag, -lift])
    np.savetxt(tmp_path / "series.csv", table, delimiter=",", header="time,drag,lift", comments="")
    (tmp_path / "log.lammps").write_text("FSI velocity 3\nFSI Re 300\nFSI part half\n")
    found = {}

    class Summary:
        def add(self, name, value, *_):
            found[name] = value
    ANALYSIS.add(Summary(), tmp_path, "_x")
    assert found == {"drag_x": pytest.approx(0.656, rel=1e-3), "strouhal_x":
                         pytest.approx(0.137, rel=0.01), "lift_x": pytest.approx(0.069, rel=0.02),
                     "lift_amplitude_x": pytest.approx(0.016, rel=0.03)}
