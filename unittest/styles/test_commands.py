"""LAMMPS' own commands beside the package: replicate, read_dump, special_bonds, suffix."""

import numpy as np
import pytest
from decks import deck
from scenes import RUBBER, WATER, close, difference, differing, run, watch

SHAKEN = """displace_atoms all random 0.002 0.002 0 7 units box
variable u atom 0.3*sin(5*PI*y)
velocity all set v_u 0.1 0 units box
"""
STEPS = watch(every=40) + "run 40\n"


def cell(made="", *lines, **more):
    """Water beside a body, both shaken, periodic."""
    return deck("0 0.4 0 0.4", 0.02, {"water": WATER, "rubber": RUBBER}, *lines, boundary="p p p",
                made=SHAKEN + made, solid="artificial/visc 0.1 0", water="0 0.2 0 0.4",
                fluid="sound 10 tension yes artificial/visc 0.1 0 density/diffusion 0.1",
                plate="0.2 0.4 0 0.4", **more)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return run(tmp_path_factory.mktemp("plain"), cell("", STEPS)).frames()


def test_replicate(tmp_path, plain):
    """Three by two copies of the cell, on two ranks: each does what the cell does. LAMMPS gives a
    copy of a body another molecule in styles with bonds only: here all are of one."""
    frames = run(tmp_path, cell("replicate 3 2 1\n", STEPS), 2).frames()
    place = lambda f: np.lexsort(np.round([f["x"] % 0.4, f["y"] % 0.4, f["type"]], 7))
    for one, many in zip(plain, frames, strict=True):
        a, b = np.repeat(place(one), 6), place(many)
        assert len(b) == len(a) == 2400 and set(many["mol"]) == {0, 1}
        d = one.vector()[a] - many.vector()[b]
        assert np.abs(d - [0.4, 0.4, 1] * np.round(d / [0.4, 0.4, 1])).max() < 1e-13
    for names in (("vx", "vy"), ("rho",), ("sxx", "syy", "sxy")):    # after 40 steps
        close(many.vector(names)[b], one.vector(names)[a], 1e-10)


def test_read_dump(tmp_path):
    """The state of the start comes back out of a dump between runs, densities and strains by the
    places alone: what follows is what followed, to the round-off of other lists."""
    back = "undump atoms\nread_dump atoms.dump 0 x y vx vy\nuncompute atoms\n"
    text = cell("", STEPS + back + watch("again.dump", 40) + "run 40", sph="fluid summation")
    done = run(tmp_path, text.replace("density/diffusion 0.1", ""))
    for first, again in zip(done.frames(), done.frames("again.dump"), strict=True):
        for quantity in ("x", "v", "rho"):
            assert difference(first, again, quantity) < 1e-12, quantity
    assert difference(first, again, "stress") < 1e-10


@pytest.mark.parametrize("command",
                         ["special_bonds lj/coul 0.5 0.5 0.5", "suffix omp", "suffix kk"])
def test_changes_nothing(tmp_path, plain, command):
    """Weights of bonded neighbors, of which there are none; a suffix that no style here has."""
    last = run(tmp_path, cell("", STEPS, before=[command])).frames()[-1]
    assert differing(last, plain[-1]) == []
