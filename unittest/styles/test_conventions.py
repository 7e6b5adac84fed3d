"""What LAMMPS users expect of every style: options of fix_modify, pairwise energies, data files,
outputs of each particle."""

import re

import numpy as np
import pytest
from lammps import lammps as Library

from decks import WALL, deck
from scenes import RUBBER, WATER, Scene, lammps, lattice, run

DX = 0.01


def scene(solid="fsi/solid", **named):
    """Water between a wall and a plate."""
    named = named or {"water": WATER + " sound 10", "rubber": RUBBER, "stone": WALL}
    return deck("-0.1 0.3 -0.1 0.3", DX, named, made="group moving type 1 2", group="moving",
                fluid="", solid_style=solid, dt=1e-5, water="0 0.1 0 0.1", plate="0.1 0.14 0 0.1",
                wall="-0.04 0 0 0.1")


FIXES = {
    "fsi": "", "fsi/stress": "", "fsi/dt": "fix 2 all fsi/dt 10",
    "fsi/watch": "fix 2 all fsi/watch 10",
    "fsi/report": "fix 2 all fsi/report", "fsi/wall/mirror": "fix 2 water fsi/wall/mirror ylo 0",
    "fsi/wall/particle": "fix 2 wall fsi/wall/particle",
    "fsi/move": "fix 2 wall fsi/move linear 0 0 0", "fsi/stream": "region z block 0 0.05 INF INF "
    "INF INF\nfix 2 water fsi/stream 1 0 NULL region z rate 100",
}


@pytest.mark.parametrize("style", FIXES)
def test_fix_modify(style):
    """No fix has a potential energy or virial of its own, or levels of rRESPA: LAMMPS says so."""
    lmp = Library(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    for line in (scene() + FIXES[style]).strip().splitlines():
        lmp.command(line)
    for option in ("energy yes", "virial yes", "respa 1"):
        with pytest.raises(
            Exception, match=f"(does not support|Illegal) fix_modify {option.split()[0]} command"):
            lmp.command("fix_modify "
                        f"{dict(fsi='sph').get(style, 'stress' if style == 'fsi/stress' else 2)} "
                        f"{option}")
    lmp.close()


@pytest.mark.parametrize("solid", ("fsi/solid", "fsi/solid/tl"))
@pytest.mark.parametrize("command",
                         ("pair_write 1 1 10 r 0.001 0.01 table.txt water 0 0",
                          "compute g water group/group water\nthermo_style custom step c_g\nrun 0"))
def test_no_single(tmp_path, solid, command):
    """There is no energy of one pair, so LAMMPS refuses what asks for it."""
    done = lammps(tmp_path, scene(solid) + "fix 3 wall fsi/wall/particle\nrun 0\n" + command + "\n")
    assert done.status and re.search("does not support (pair_write|compute group/group)|single",
                                     done.errors[0]), done.errors


@pytest.mark.parametrize("solid", ("fsi/solid", "fsi/solid/tl", None))
def test_data_file_says_what_is_lost(tmp_path, solid):
    """A word about strain and stress where there are solids; none where all that a particle has is
    in the file."""
    text = scene(solid) if solid else scene(water=WATER + " sound 10", other=WATER + " sound 10",
                                            stone=WALL)
    done = run(tmp_path, text + "fix 3 wall fsi/wall/particle\nrun 1\nwrite_data end.data\n", 2)
    assert ("WARNING: Data files hold no strain, stress or bonds of solids" in done.output) == (
        solid is not None)


def test_bonds():
    """A block, torn in two: bonds are the neighbors within the support at the start, and less those
    to the other half afterwards."""
    x = lattice((8, 6), DX)
    left = x[:, 0] < 4 * DX
    with Scene(x, dx=DX, materials=(WATER, RUBBER), type=2, solid_style="fsi/solid/tl",
               solid="damage 0.2",
               commands=["compute b all fsi/atom bonds"]) as s:
        r = np.linalg.norm(x[:, None] - x[None], axis=2)
        near = (r < s.kernel.cut * (1 - 1e-9)) & (r > 0)
        s.lmp.command("fix keep all ave/atom 1 1 1 c_b")
        assert np.array_equal(s.run(1).compute("b", columns=False), near.sum(1))
        s.put("x", s.get("x") + np.where(left, 0, 3 * DX)[:, None] * [1, 0, 0])
        s.run(0)
        s.put("x", s.get("x"))
        s.lmp.command("neighbor 0.06 bin")
        after = s.run(1).compute("b", columns=False)
        assert np.array_equal(after, (near & (left[:, None] == left[None])).sum(1))


def test_masses_before_the_first_run(tmp_path):
    """Computes and fixes of LAMMPS that ask for masses when they are set up have those of the
    package: a spring and a rigid body that stand before fix fsi, too."""
    text = deck("-0.1 0.3 -0.1 0.3", DX, {"water": WATER, "stone": WALL},
                "fix w wall fsi/wall/particle",
                made="group still type 1\nfix spring wall spring tether 100 0.05 -0.02 0 0\n"
                "fix raft wall rigid single force * off off off torque * off off off",
                group="still", dt=1e-5, water="0 0.1 0 0.1", wall="0 0.1 -0.04 0")
    text += ("compute middle water com\ncompute size water gyration\n"
             "thermo_style custom step c_middle[1] c_middle[2] c_size f_spring[4]\nrun 0\n")
    say = 'print "$(c_middle[1]:%.12g) $(c_middle[2]:%.12g) $(c_size:%.12g) $(f_spring[4]:%.12g)"\n'
    output = run(tmp_path, text + say.replace('"$', '"found $')).output
    found = np.array(re.search(r"^found (\S+) (\S+) (\S+) (\S+)$", output, re.M).groups(), float)
    x = np.arange(0.005, 0.1, DX)
    np.testing.assert_allclose(found, [x.mean(), x.mean(), np.sqrt(2 * x.var()), 0.0], rtol=1e-9,
                               atol=1e-9)
