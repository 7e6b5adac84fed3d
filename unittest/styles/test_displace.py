"""Command fsi/displace: a body takes the place of as much fluid as it covers, wherever the two
lattices lie."""

import re

import numpy as np
import pytest

from scenes import lammps, run

DECK = """units si
dimension {dim}
boundary f f {z}
atom_style fsi
region box block -0.1 0.5 -0.1 0.5 {low} {high}
create_box 2 box
lattice {lattice} 0.01 origin 0.5 0.5 {half}
region tank block 0 0.3 0 0.2 {depth} units box
create_atoms 1 region tank
lattice {lattice} {fine} origin {origin}
region body block 0.1 0.2 {bottom} {top} {depth} units box
create_atoms 2 region body
group water type 1
group body type 2
displace_atoms body rotate 0.15 0.1 {mid} 0 0 1 {angle} units box
fsi/material w fluid rho 1000
fsi/material b wall rho 500
pair_style fsi/fluid sound 25
pair_coeff * * NULL w b
neighbor 0.004 bin
fix 1 water fsi 0.01 wendland 1.5 spacing 2 {fine}
fix 2 body fsi/wall/particle
fsi/displace {groups}
write_dump all custom left.dump id type x y z modify sort id time yes
run 0
"""
FLAT = {"dim": 2, "z": "p", "low": -0.005, "high": 0.005, "lattice": "sq", "half": 0,
        "depth": "INF INF", "fine": 0.01, "origin": "0.5 0.5 0", "bottom": 0.07,
        "top": 0.13, "mid": 0, "angle": 0, "groups": "water body"}
DEEP = {"dim": 3, "z": "f", "low": -0.1, "high": 0.3, "lattice": "sc", "half": 0.5,
        "depth": "0 0.1", "origin": "0.5 0.5 0.5", "mid": 0.05}
CASES = {"same lattice": {}, "half a spacing aside": {"origin": "0 0.5 0"},
         "between": {"origin": "0.37 0.71 0"}, "turned": {"angle": 30},
         "a finer one": {"fine": 0.004}, "half out": {"bottom": 0.15, "top": 0.25},
         "thinner than a cell": {"fine": 0.0025, "bottom": 0.0975, "top": 0.1025},
         "3D": DEEP, "3D, turned": {**DEEP, "angle": 20}}


def left(folder, ranks=1, **changes):
    """Particles after the command."""
    return run(folder, DECK.format(**{**FLAT, **changes}), ranks).frames("left.dump")[-1]


@pytest.mark.parametrize("name", CASES)
def test_what_goes_is_what_the_body_covers(tmp_path, name):
    """Half a particle is what a whole number of them allows; of the half that is out of the water
    nothing is displaced."""
    given = {**FLAT, **CASES[name]}
    frame = left(tmp_path, **CASES[name])
    cell = 0.01**given["dim"]
    bodies = np.sum(frame["type"] == 2) * given["fine"]**given["dim"] * (0.5 if name == "half out"
                                                                         else 1)
    taken = 30 * 20 * (1 if given["dim"] == 2 else 10) - np.sum(frame["type"] == 1)
    assert abs(taken - bodies / cell) <= 0.5 + 1e-9
    x = frame.vector(("x", "y", "z"))
    apart = np.linalg.norm(x[frame["type"] == 1][:, None] - x[frame["type"] == 2], axis=2).min()
    assert apart >= 0.9 * 0.5 * (0.01 + given["fine"]) - 1e-6    # the wall's guard
    if name == "same lattice":
        assert taken == 60 and apart > 0.0099


def test_ranks(tmp_path):
    """The same particles go, and move, on any number of ranks, also where rows on both sides are
    half covered."""
    one, four = (left(tmp_path / str(ranks), ranks, origin="0.5 0 0") for ranks in (1, 4))
    places = [{(kind, round(x, 6), round(y, 6)) for kind, x, y in zip(f["type"], f["x"], f["y"])}
              for f in (one, four)]
    assert places[0] == places[1]


def test_no_push_at_the_start(tmp_path):
    """Of still water on the turned wall: the weight of what it displaces, not the guard's push."""
    run(tmp_path, DECK.format(**{**FLAT, "angle": 30}).replace("write_dump", "fix g all gravity 10 "
        "vector 0 -1 0\nfix m water fsi/wall/mirror xlo 0 xhi 0.3 ylo 0\nfsi/set water hydrostatic "
        "0.2\ncompute f body fsi/force\nwrite_dump") + "variable f equal c_f[2]\nrun 0\n"
        "print '${f}' file force\n")
    assert float((tmp_path / "force").read_text()) == pytest.approx(60, rel=0.1)


@pytest.mark.parametrize("groups, error", [
    ("water", r"Illegal fsi/displace command: missing argument"),
    ("water nobody", r"Fsi/displace group-ID nobody does not exist"),
    ("body body", r"Fsi/displace group-ID body has no particle of a fluid"),
    ("water water", r"Fsi/displace group-ID water has no particle of a body")])
def test_refusals(tmp_path, groups, error):
    done = lammps(tmp_path, DECK.format(**{**FLAT, "groups": groups}))
    assert done.status != 0 and re.search(error, done.errors[0])
