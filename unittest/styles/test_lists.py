"""When neighbor lists are new: they go along with a stream, and nothing depends on it."""

import re

import numpy as np
import pytest
from decks import INVISCID, deck
from scenes import difference, run, watch

SHAKEN = "reset_atoms id sort yes\ndisplace_atoms all random 0.005 0.005 0 1 units box\n"


def stream(folder, u, steps, ranks=1, grid="* * *", start="", more="", check="yes", y="p"):
    """The run and how many lists it made."""
    text = deck("0 1 0 1", 0.05, INVISCID, more, f"neigh_modify every 1 delay 0 check {check}",
                "thermo_modify lost error", water="", boundary=f"p {y} p",
                before=[f"processors {grid}"],
                made=f"{start}variable u atom {u}\nvelocity all set v_u 0 0 units box", dt=1e-3,
                skin=0.41,
                fluid="sound 20 tension yes density/diffusion 0.1")
    result = run(folder, text + watch(every=steps) + f"run {steps}\n", ranks)
    return result, int(re.search(r"Neighbor list builds = (\d+)", result.output)[1])


@pytest.mark.parametrize("u, more, last",
                         [("1", "", 21), ("2*(y>0.5)-1", "", 11),
                          ("1", "fix w all fsi/wall/mirror ylo 0 velocity 0 1e-9 0", 11)],
                         ids=["stream", "two streams", "a wall that moves"])
def test_lists_last_as_long_as_pairs_allow(tmp_path, u, more, last):
    """A stream of 1 m/s goes 1 mm a step. Lists that hold for half a skin, 10.25 mm, are new in the
    11th step; those that go along for half a skin in the 21st. Where streams go both ways, or walls
    move, nothing goes along. The first step of a run has new ones in any case."""
    steps = 100
    assert stream(tmp_path, u, steps, more=more,
                  y="f" if more else "p")[1] == 1 + (steps - 1) // last


@pytest.mark.parametrize("ranks, grid", [(1, "1 1 1"), (2, "1 2 1"), (4, "2 2 1")])
def test_nothing_depends_on_it(tmp_path, ranks, grid):
    """Two streams of 0.75 m/s against each other, each on ranks of its own: the same as with lists
    that are new in every step, to round-off. Pairs that lists lack show at 1e-6 and above."""
    u = "1.5*(y>0.5)-0.75"
    want, every = stream(tmp_path / "every", u, 60, start=SHAKEN, check="no")
    got, some = stream(tmp_path / "some", u, 60, ranks, grid, SHAKEN)
    assert every == 60 > some
    a, b = want.frames()[-1], got.frames()[-1]
    assert np.abs(a.vector(("vx", "vy", "vz"))).max() > 0.7
    apart = a.vector() - b.vector()
    assert np.abs(apart - np.round(apart)).max() < 1e-10  # wrapped round the box at other times
    for quantity in ("v", "rho"):
        assert difference(a, b, quantity) < 1e-10, quantity


def test_groups_that_change(tmp_path):
    """In steps that keep their lists: the gravity of a group in which all are from step 11 on is
    one that a variable turns on then; a gauge of a group in which all are in odd steps, none in
    even ones, shows what one of all shows, or 0. With groups as they were when lists were new,
    velocities differ by 3 %."""
    gauge = "point 0.1 0.1 0\n"
    gravity = {
        "variable": "variable g equal 9.81*(step>10)\nfix g all gravity v_g vector 0 -1 0",
        "group": "variable late atom step>10\ngroup late dynamic all var late every 1\n"
                 "fix g late gravity 9.81 vector 0 -1 0"}
    last = {}
    for name, lines in gravity.items():
        text = deck("0 0.3 0 0.3", 0.02, INVISCID, "fix walls all fsi/wall/mirror xlo 0 ylo 0",
                    lines, "variable odd atom step%2\ngroup odd dynamic all var odd every 1",
                    f"compute one all fsi/probe p {gauge}compute two odd fsi/probe p {gauge}"
                    "thermo 1\nthermo_style custom step c_one c_two\n"
                    "thermo_modify format float %.17g", water="0 0.2 0 0.2",
                    fluid="sound 20 density/diffusion 0.1", dt=2e-4)
        done = run(tmp_path / name, text + watch(every=40) + "run 40\n")
        rows = re.findall(r"^ +(\d+) +(\d\S*) +(\d\S*) *$", done.output, re.M)
        assert len(rows) == 41 and "Neighbor list builds = 1\n" in done.output
        assert float(rows[-1][1]) > 10.0
        for step, of_all, of_odd in rows:
            assert float(of_odd) == (float(of_all) if int(step) % 2 else 0.0), step
        last[name] = done.frames()[-1]
    for quantity in ("x", "v", "rho"):
        assert difference(last["variable"], last["group"], quantity) < 1e-14, quantity
