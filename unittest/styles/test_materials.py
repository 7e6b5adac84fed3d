"""Command fsi/material: materials of the script and of several files beside those of pair_coeff's
file."""

import re

import pytest
from decks import box, materials
from scenes import WATER, lammps, run

SETUP = box("-0.05 0.15 -0.05 0.15", 0.01, water="0 0.05 0 0.08", plate="0.05 0.08 0 0.08")
PAIRS = """pair_style hybrid fsi/fluid sound 12.5 fsi/solid/tl
pair_coeff * * fsi/fluid {file} water_inviscid {plate}
pair_coeff * * fsi/solid/tl {file} NULL {plate}
"""
REST = """fix sph all fsi 0.01 wendland 1.5
fix g all gravity 9.81 vector 0 -1 0
timestep 4e-5
neighbor 0.003 bin
run 20
variable f equal fcm(plate,x)
variable y equal xcm(plate,y)
print "END ${f} ${y}"
"""
RUBBER = "solid rho 1100 young 3e6 poisson 0.45"
MINE = materials(rubber=RUBBER, water_inviscid="fluid rho 500")


def end(result):
    return re.findall(r"^END (.*)", result.output, re.M)[-1]


@pytest.fixture(scope="module")
def expected(tmp_path_factory):
    """All in one file."""
    return end(run(tmp_path_factory.mktemp("whole"),
                   SETUP + PAIRS.format(file="whole.fsi", plate="rubber") + REST,
                   whole_fsi=materials(rubber=RUBBER, water_inviscid=WATER)))


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("given, file", [
    (f"fsi/material rubber {RUBBER}\n", "materials.fsi"),  # beside the bundled file
    # without a file
    (f"fsi/material rubber {RUBBER}\nfsi/material water_inviscid fluid rho 1000\n", "NULL"),
    # another file; a name given again is the new one
    ("fsi/material file mine.fsi\nfsi/material water_inviscid fluid rho 1000\n", "materials.fsi"),
    (f"fsi/material rubber solid rho 1 young 1 poisson 0\nfsi/material rubber {RUBBER}\n",
     "materials.fsi")])
def test_materials_of_several_places(tmp_path, expected, given, file, ranks):
    result = run(tmp_path, SETUP + given + PAIRS.format(file=file, plate="rubber") + REST, ranks,
                 mine_fsi=MINE)
    # to the last digit; IDs and sums of two ranks differ
    assert ranks == 2 or end(result) == expected


def test_what_the_script_gives_comes_first(tmp_path):
    """Before what the file has by that name."""
    other = f"fsi/material water_inviscid fluid rho 900\nfsi/material rubber {RUBBER}\n"
    text = (SETUP + other + PAIRS.format(file="materials.fsi", plate="rubber") + REST
            + 'variable m equal mass(all)-mass(plate)\nprint "MASS ${m}"\n')
    # the mass of the stress-free lattice is that of the kernel
    assert float(re.search(r"^MASS (\S+)", run(tmp_path, text).output, re.M)[1]) == pytest.approx(
        900 * 0.05 * 0.08, rel=0.01)


def test_not_before_pair_coeff_is_given_again(tmp_path, expected):
    """A material given anew is that of the next pair_coeff."""
    text = SETUP + f"fsi/material rubber {RUBBER}\n" + PAIRS.format(
        file="materials.fsi", plate="rubber") + "fsi/material rubber fluid rho 3\n" + REST
    assert end(run(tmp_path, text)) == expected


def test_unknown_names_are_listed(tmp_path):
    done = lammps(tmp_path, SETUP + f"fsi/material rubber {RUBBER}\n"
                  + PAIRS.format(file="mine.fsi", plate="plastic") + REST, mine_fsi=MINE)
    assert (done.status != 0 and "Material plastic not found in file mine.fsi, which has: rubber "
            "water_inviscid; command fsi/material has given: rubber" in done.errors[0])


def test_restart(tmp_path):
    """A restart file has the materials of a pair style that is no hybrid, wherever they came from;
    of a hybrid style they are given again."""
    alone = (SETUP.replace("create_atoms 1 region water\n", "") + f"fsi/material rubber {RUBBER}\n"
             "pair_style fsi/solid/tl\npair_coeff * * NULL rubber rubber\n" + REST)
    go_on = ("fix sph all fsi 0.01 wendland 1.5\ntimestep 4e-5\nneighbor 0.003 bin\n"
             "group plate type 2\nfix g all gravity 9.81 vector 0 -1 0\nrun 20\n"
             + REST[REST.index("variable"):])
    run(tmp_path, alone + "write_restart r.1\n")
    assert end(run(tmp_path / "whole", alone + REST[REST.index("run"):])) == end(
        run(tmp_path / "on", f"read_restart {tmp_path}/r.1\n" + go_on))
    hybrid = SETUP + f"fsi/material rubber {RUBBER}\n" + PAIRS.format(
        file="materials.fsi", plate="rubber") + REST + "write_restart r.2\n"
    run(tmp_path, hybrid)
    again = "\n".join(line
                      for line in PAIRS.format(file="materials.fsi", plate="rubber").splitlines()
                      if line.startswith("pair_coeff")) + "\n"
    forgot = lammps(tmp_path, "read_restart r.2\n" + again + go_on)
    assert (forgot.status != 0
            and "Material rubber not found in file materials.fsi" in forgot.errors[0])
    run(tmp_path, f"read_restart r.2\nfsi/material rubber {RUBBER}\n" + again + go_on)
