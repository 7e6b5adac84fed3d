"""Warnings about legal numbers that are most likely not what was meant: each appears when it
should, alone."""

import re

import pytest
from decks import box, deck, materials
from scenes import RUBBER, WATER, lammps, run

# 5 x 8 particles of water, 0.08 m high, beside a plate of 3; sqrt(2gH) = 1.25 m/s; the plate's
# longitudinal waves run at 64.8 m/s
DECK = box("-0.05 0.15 -0.05 0.15", 0.01, water="0 0.05 0 0.08", plate="0.05 0.08 0 0.08") + """pair_style hybrid fsi/fluid sound 12.53 fsi/solid/tl
pair_coeff * * fsi/fluid materials.fsi water_inviscid plate
pair_coeff * * fsi/solid/tl materials.fsi NULL plate
fix sph all fsi 0.01 wendland 1.5
fix g all gravity 9.81 vector 0 -1 0
fix walls all fsi/wall/mirror xlo 0 ylo 0
timestep 4e-5
neighbor 0.003 bin
run 0
"""
MATERIALS = materials(water_inviscid=WATER, plate="solid rho {rho} young {young} poisson 0.4")


def test_fluid_made_between_runs(tmp_path):
    """It is in no group that fix fsi moves: said where it is new, and once."""
    new = "create_atoms 1 single {} 0.12 0 units box\nrun 0\n"
    text = DECK.replace("fix sph all", "group moving union all\nfix sph moving") + new.format(
        0.02) + "run 0\n" + new.format(0.04)
    found = [line for line in run(tmp_path, text).output.splitlines() if "are not in group" in line]
    assert [re.search(r"(\d+) fluid particles, the first of them atom (\d+), are not in group "
                      r"moving of fix sph", line).groups() for line in found] == [
        ("1", "65"), ("2", "65")]


@pytest.mark.parametrize("push, ranks, every",
                         [(15.0, 1, ""), (15.0, 2, " every 100 NULL"), (1.0, 1, "")])
def test_sound_too_slow_for_the_pressures(tmp_path, push, ranks, every):
    """A closed box of viscous fluid that a force presses to one side: p = push * 0.2 m * rho at its
    other end is 0.15 rho c^2 there, or 0.01. The advice is 10 sqrt(p/rho) = 17 m/s, here from the
    first 3 % that sound makes, which goes to and fro. Said once, in however many runs."""
    text = deck("0 0.1 -0.05 0.25", 0.01, {"sirup": WATER + " viscosity 1"},
                "fix walls all fsi/wall/mirror ylo 0 yhi 0.2", f"variable f equal {push}*0.1",
                "fix push all addforce 0 v_f 0", f"run 500{every}", boundary="p f p",
                fluid="sound 4.5 tension yes laminar/visc artificial/visc 0.5 0", dt=2e-4,
                water="INF INF 0 0.2")
    output = run(tmp_path, text, ranks).output
    found = re.findall(r"WARNING: Fix fsi: densities of the fluid of type 1 differ .* by (\S+) % "
                       r".* speed of sound 4.5. Expected sound (\S+), 10 times", output)
    print(found)
    assert len(found) == (push == 15.0)
    for by, sound in found:
        assert 3 <= float(by) < 4 and 13 < float(sound) < 18


def mine(**what):
    return [("materials.fsi", "mine.fsi")], MATERIALS.format(**{"rho": 1000, "young": 2e6, **what})


# the plate as a wall of particles
WALL = [("fix g all", "group water type 1\nfix w plate fsi/wall/particle\nfix g all"),
        ("set group plate mol 1\n", ""),
        ("hybrid fsi/fluid sound 12.53", "fsi/fluid sound 12.53"), (" fsi/solid/tl\n", "\n"),
        ("pair_coeff * * fsi/fluid materials.fsi water_inviscid plate\n",
         "fsi/material bed wall rho 500\npair_coeff * * materials.fsi water_inviscid bed\n"),
        ("pair_coeff * * fsi/solid/tl materials.fsi NULL plate\n", ""),
        ("fix sph all", "fix sph water")]
TWO_BODIES = [("set group plate mol 1\n", "set group plate mol 1\nregion up block INF INF 0.04 INF "
               "INF INF units box\ngroup up region up\ngroup up intersect up plate\n"
               "set group up mol 2\n"), ("fsi/solid/tl\npair", "fsi/solid/tl contact 2.5\npair")]

CASES = {
    # largest c without a warning is 7 sqrt(2gH) = 8.77
    "sound": ([("sound 12.53", "sound 8.7")], None, r"speed of sound 8.7 .* 6.9 times sqrt\(2gH\) "
              r"of its height H = 0.08, 1.25: .* sound 12.5$"),
    "speed": ([("run 0", "velocity all set 3 4 0 units box\nrun 0"), ("4e-5", "3e-5")], None,
              r"2.5 times its speed at the start, 5: .* sound 50$"),
    "lattice units": ([("run 0", "velocity all set 2 0 0\nrun 0"), ("fix g all", "#")], None,
                      r"speed of sound 12.53 .* 6.3e\+02 times the speed 0.02 .*: velocity \.\.\. "
                      r"units box"),
    "spacing": ([("fsi 0.01", "fsi 0.0085"), ("4e-5", "3e-5")], None,
                r"nearest neighbors are 0.01 apart on average, but the spacing is 0.0085"),
    "wide": ([("fsi 0.01", "fsi 0.0125"), ("4e-5", "5e-5"),
              ("water block 0 0.05 0 0.08", "water block 0 0.05 0 0.12")], None,
             r"nearest neighbors are 0.01 apart on average, but the spacing is 0.0125"),
    "coarse": ([("sq 0.01", "sq 0.013")], None,
               r"most particles have no neighbor within 0.0125: is 0.01 the spacing"),
    "overlap": ([("run 0", "create_atoms 1 single 0.028 0.025 0 units box\nrun 0")], None,
                r"atoms 13 and 65 are 0.3 spacings apart"),
    # a block of 2 x 2 on a lattice half a spacing aside, with all of it in the plate
    "inside": ([("run 0", "lattice sq 0.01 origin 0 0 0\nregion more block 0.055 0.075 0.025 0.045 "
                 "INF INF units box\ncreate_atoms 1 region more\nrun 0")], None,
               r"4 fluid particles, the first of them atom 65, are inside a body or wall: "
               r"fsi/displace"),
    "excluded": ([("run 0", "group plates type 2\nneigh_modify exclude group plates all\nrun 0")],
                 None,
                 r"neigh_modify exclude hides neighbors from 40 particles, the first of them "
                 r"atom 1"),
    "excluded solids": ([("fsi/solid/tl", "fsi/solid"),
                         ("run 0", "fix stress all fsi/stress\ngroup plates type 2\n"
                          "neigh_modify exclude group plates plates\nrun 0")], None,
                        r"neigh_modify exclude hides neighbors from 24 particles, the first of "
                        r"them atom 41"),
    "around": ([("boundary f f p", "boundary p f p"),
                ("box block -0.05 0.15", "box block 0.0045 0.0755"),
                ("water block 0 0.05", "water block INF INF"),
                ("walls all fsi/wall/mirror xlo 0", "walls all fsi/wall/mirror"),
                ("create_atoms 2 region plate", "")], None,
               r"atoms 1 and 8 are 0.1 spacings apart around the periodic box: make it a whole "
               r"number of spacings long in x"),
    "row off": ([("xlo 0", "xlo -0.004")], None, r"first row of fluid is 0.9 spacings from the "
                r"mirror wall at x = -0.004, not half of one"),
    "gap around": ([("boundary f f p", "boundary p f p"),
                    ("box block -0.05 0.15", "box block 0 0.0732"),
                    ("water block 0 0.05", "water block INF INF"),
                    ("walls all fsi/wall/mirror xlo 0", "walls all fsi/wall/mirror"),
                    ("create_atoms 2 region plate", "")], None,
                   r"rows are 1.3 spacings apart around the periodic box: make it a whole number "
                   r"of spacings long in x"),
    "idle": ([("fix sph all", "group moving type 2\ngroup some id 1:20\n"
               "group moving union moving some\nfix sph moving")], None,
             r"20 fluid particles, the first of them atom 21, are not in group moving of fix sph"),
    # alpha h c/16 = 2.9e-3 against 1e-3/1000*1000
    "alpha": ([("sound 12.53", "sound 12.53 artificial/visc 0.25 0 laminar/visc"),
               ("water_inviscid", "sirup"), ("materials.fsi", "mine.fsi")],
              MATERIALS.format(rho=1000, young=2e6).replace("water_inviscid", "sirup").replace(
                  "fluid rho 1000", "fluid rho 1000 viscosity 1.0"),
              r"artificial viscosity of type 1 is worth 0.0029, 2.9 times its laminar viscosity "
              r"0.001: take alpha 0.009 or less"),
    "periodic": ([("boundary f f p", "boundary p f p"),
                  ("box block -0.05 0.15", "box block 0 0.05"),
                  ("walls all fsi/wall/mirror xlo 0", "walls all fsi/wall/mirror"),
                  ("create_atoms 2 region plate", "")], None,
                 r"periodic box is 0.05 long in x, less than twice the kernel's support 0.03"),
    # 0.4 h/c_l = 9.25e-5, h/c = 1.2e-3
    "long solid": ([("4e-5", "9.5e-5")], None, r"time step 9.5e-05 is too long for elastic waves "
                   r"in the solid, 9.25e-05 at most: timestep 5.78e-05"),
    "long fluid": ([("4e-5", "1.3e-3"), ("1.5\n", "1.5 substeps 40\n")], None,
                   r"too long for sound in the fluid, 0.0012 at most"),
    "viscous": ([("sound 12.53", "sound 12.53 laminar/visc"), ("water_inviscid", "sirup"),
                 ("materials.fsi", "mine.fsi")],
                MATERIALS.format(rho=1000, young=2e6).replace("water_inviscid", "sirup").replace(
                    "fluid rho 1000", "fluid rho 1000 viscosity 2000"),
                r"too long for laminar viscosity, 2.81e-05 at most"),
    "short": ([("4e-5", "1e-8")], None, r"time step 1e-08 is 5.8e\+03 times shorter"),
    "default": ([("timestep 4e-5\n", "")], None, r"time step 1e-08, LAMMPS' default, is"),
    "grams": (*mine(rho=1.0e-3), r"density 0.001 of type 2 is that of no material in units si, in "
              r"which water has 1000"),
    "megapascal": (*mine(young=2.0),
                   r"elastic waves in type 2 run at 0.065 m/s only: moduli are in pascal"),
    # K = young/3(1 - 2 0.4) = 3.33e4
    "soft": ([("sound 12.53", "sound 12.53 background 2e3 tension yes"), *mine(young=2e4)[0]],
             mine(young=2e4)[1],
             r"background pressure 2000 compresses bodies of type 2, of bulk modulus 3.33e\+04, by "
             r"6 % of their volume: take less"),
    "yield": ([("materials.fsi", "mine.fsi")],
              MATERIALS.format(rho=1000, young=2e6).replace("poisson 0.4", "poisson 0.4 yield 1e4"),
              r"material of type 2 has a yield stress, but stays elastic: .* fix fsi/stress \.\.\. "
              r"plastic"),
    "contact": (TWO_BODIES, None, r"bodies 1 and 2 begin 1 spacings apart at the start, and "
                r"contact reaches 2.5: it pushes at once. Move them apart, or contact 1$"),
    # a second plate on a lattice half a spacing aside
    "bodies overlap": ([("run 0",
                         "lattice sq 0.01 origin 0 0 0\nregion more block 0.055 0.085 0.015 0.075 "
                         "INF INF units box\ngroup old type 2\ncreate_atoms 2 region more\n"
                         "group more subtract all old\ngroup wet type 1\n"
                         "group more subtract more wet\nset group more mol 2\nrun 0")], None,
                       r"bodies 1 and 2 overlap, with particles 0.71 spacings apart at the start, "
                       r"and contact reaches 1: it pushes at once. Move them apart$"),
    "held": ([("fix sph all", "group water type 1\nfix sph water")], None,
             r"all 24 particles of elastic bodies, the first of them atom 41, are not in group "
             r"water of fix sph: they stay"),
    "weightless body": ([("fix g all", "group water type 1\nfix g water")], None,
                        r"24 moving particles of elastic bodies, the first of them atom 41, are in "
                        r"the group of no fix gravity, while others are"),
    # weight keeps a stream together, and so does tension: test_stream_that_cannot_tear
    "torn stream": ([("fix g all", "region zone block 0 0.02 INF INF INF INF units box\n"
                      "fix s all fsi/stream 0.1 0 NULL region zone rate 10\n#"),
                     ("create_atoms 2 region plate", "")], None,
                    r"a stream without tension opens holes .* background of about rho U\^2, U "
                    r"being its largest speed, and tension yes$"),
    "weightless fluid": ([("fix g all", "fix g plate")], None, r"40 moving particles of fluids, "
                         r"the first of them atom 1, are in the group of no fix gravity"),
    "pressed": ([(old, new.replace("sound 12.53", "preset closed 1.253")) for old, new in WALL],
                None,
                r"with gravity shifting at walls of particles feeds the fluid energy: leave fix "
                r"gravity out, .* preset closed shift 0$"),
    "standing": ([*WALL, ("run 0", "velocity plate set -0.1 0 0 units box\nrun 0")], None,
                 r"8 wall particles, the first of them atom 41, have a velocity across their face, "
                 r"and no fix moves them: fix move or fix fsi/move$"),
    "nothing acts": ([("fix g all gravity 9.81 vector 0 -1 0\n", "")], None,
                     r"nothing moves this scene: no gravity, no velocity"),
    "shallow": ([("block 0 0.05 0 0.08", "block 0 0.05 0 0.07")], None,
                r"fluid is 7 spacings deep on the mirror wall at y = 0: .* less than 8 rows sink "
                r"there, .* Give it hydrostatic yes, or build the wall of particles$"),
    "cut by a mirror": ([("xlo 0 ylo 0", "xlo 0 xhi 0.08 ylo 0")], None,
                        r"body 1 ends at the mirror wall at x = 0.08, and its face there is free"),
}
# a support of 4 spacings, a plate of 2, and water behind it
THIN = [("wendland 1.5", "wendland 2"), ("0.05 0.08 0 0.08", "0.05 0.07 0 0.08"),
        ("create_atoms 1 region water", "create_atoms 1 region water\n"
         "region behind block 0.07 0.12 0 0.08 INF INF units box\ncreate_atoms 1 region behind")]
CASES["thin"] = (THIN, None, r"fluid atom 5 sees fluid on the other side of a body or wall of type "
                 r"2, which is thinner than .* 0\.04: .* Then fix sph \.\.\. thin 2$")
ALSO = {  # what follows from the mistake as well
    "inside": r"sees fluid on the other side", "grams": r"too long for elastic",
        "megapascal": r"times shorter",
}


def advice(folder, changes=(), file=None, ranks=1):
    """The advice that LAMMPS gives on a deck, and the deck."""
    text = DECK
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    output = run(folder, text, ranks, **({"mine_fsi": file} if file else {})).output
    return [re.sub(r" \([^()]*fsi_advice.cpp:\d+\)$", "", line) for line in output.splitlines()
            if line.startswith("WARNING: Fix fsi: ")]


@pytest.mark.parametrize("line, told", [
    ("compute f water fsi/force", "Compute fsi/force .*: group water has no solid and no wall"),
    ("compute f plate fsi/force", ""),
    ("compute p plate fsi/probe p point 0.02 0.02 0",
     "Compute fsi/probe .*: group plate has no fluid"),
    ("compute p plate fsi/probe ux point 0.06 0.02 0", ""),
    ("fix f plate fsi/watch 10", "Fix fsi/watch .*: group plate has no fluid and no solid"),
    ("fix f plate fsi/watch 10 distance 0.1", ""), ("fix f all fsi/watch 10", "")])
def test_what_looks_at_nothing(tmp_path, line, told):
    text = DECK
    for old, new in WALL if "watch" in line else ():
        text = text.replace(old, new)
    output = run(tmp_path, text.replace("run 0", f"{line}\nrun 0")).output
    assert re.findall("WARNING: (.*) has nothing to act on", output) == ([told.split(" .*")[0]]
                                                                        if told else [])
    assert re.search(told.replace(".*", "has nothing to act on"), output)


def test_what_moves_a_part_may_come_after_set(tmp_path):
    """Fsi/set prepares all as a run does, but before all fixes are there."""
    moved = DECK.replace("fix sph all",
                         "group top id 62:64\ngroup rest subtract all top\nfix sph rest").replace(
        "run 0", "velocity top set 0.1 0 0 units box\nfsi/set all hydrostatic 0.08\n{}run 0")
    assert not run(tmp_path, moved.format("fix move top rigid single\n")).errors
    done = lammps(tmp_path, moved.format(""))
    assert done.status != 0 and any("neither fix fsi nor another fix moves it" in line
                                    for line in done.errors)


def test_keyword_given_twice(tmp_path):
    """Atom types may be named as often as wanted."""
    text = DECK.replace("sound 12.53", "sound 12.53 shift 0.1 sound 20").replace(
        "wendland 1.5", "wendland 1.5 spacing 1 0.01 spacing 2 0.01")
    found = [line for line in run(tmp_path, text).output.splitlines() if "given twice" in line]
    assert len(found) == 1 and found[0].startswith(
        "WARNING: pair_style fsi/fluid sound is given twice: the last counts")


def test_sound_deck_is_not_criticized(tmp_path):
    assert advice(tmp_path) == []
    # the bounds themselves: 7 sqrt(2gH), 0.4 h/c_l, three layers
    assert advice(tmp_path, [("sound 12.53", "sound 8.78"), ("4e-5", "9.1e-5")]) == []
    assert advice(tmp_path, [("block 0 0.05 0 0.08", "block 0 0.05 0 0.07"),
                             ("ylo 0", "ylo 0 hydrostatic yes")]) == []
    # a belt
    assert advice(tmp_path, [*WALL, ("run 0", "velocity plate set 0 0.1 0 units box\nrun 0")]) == []
    # a body that swings by little: of the sound decides its frequency
    assert advice(tmp_path, [("run 0", "velocity all set 1e-5 0 0 units box\nrun 0"),
                             ("fix g all", "#")]) == []
    # a thin plate that is said to be thin, and one of three layers between the same water
    assert advice(tmp_path, [*THIN, ("wendland 2", "wendland 2 thin 2")]) == []
    assert advice(tmp_path, [*THIN[2:], ("0.07 0.12", "0.08 0.12")]) == []
    # the same where coarser water is elsewhere, whose support is wider than the plate: what counts
    # is that of pairs
    coarser = ("region top block 0 0.05 0.08 0.109 INF INF units box\n"
               "lattice sq 0.0144 origin 0.5 0.0555556 0\ncreate_atoms 3 region top\n")
    assert advice(tmp_path, [("create_box 2", "create_box 3"),
                             ("group plate type", coarser + "group plate type"),
                             ("inviscid plate", "inviscid plate water_inviscid"),
                             ("NULL plate", "NULL plate NULL"),
                             ("fsi 0.01 wendland 1.5", "fsi 0.0144 wendland 1.5 spacing 1*2 0.01"),
                             *THIN[2:], ("0.07 0.12", "0.08 0.12")]) == []


ON_TWO_RANKS = ("sound", "spacing", "overlap", "idle", "long fluid", "contact", "held",
                "weightless body", "nothing acts",
                "cut by a mirror", "thin", "row off", "gap around")  # what is summed over ranks


@pytest.mark.parametrize("name, ranks", [(name, 1) for name in CASES]
                         + [(name, 2) for name in ON_TWO_RANKS])
def test_warning(tmp_path, name, ranks):
    changes, file, message = CASES[name]
    found = advice(tmp_path, changes, file, ranks)
    matching = [line for line in found if re.search(message, line)]
    assert len(matching) == 1, found
    others = [line for line in found if line not in matching]
    assert all(name in ALSO and re.search(ALSO[name], line) for line in others), others


@pytest.mark.parametrize("changes", [
    [("run 0", "velocity all set 0.1 0 0 units box\nrun 0")],
    [("run 0", "fix push all addforce 1e-9 0 0\nrun 0")],
    [("xlo 0 ylo 0", "xlo 0 velocity 0.1 0 0 ylo 0")],
    [("run 0", "fsi/set all density 1001\nrun 0")]])
def test_something_acts(tmp_path, changes):
    """A velocity, a force, a moving wall, pressure at the start: without gravity."""
    assert [line
            for line in advice(tmp_path, [("fix g all gravity 9.81 vector 0 -1 0\n", ""), *changes])
            if "nothing moves" in line] == []


def test_a_body_between_two_walls_or_held_at_one_is_not_cut(tmp_path):
    both = [("xlo 0 ylo 0", "xlo 0.05 xhi 0.08 ylo 0"),
            ("create_atoms 1 region water",
             "create_atoms 1 region water\ngroup water type 1\ndelete_atoms group water")]
    assert [line for line in advice(tmp_path / "both", both) if "ends at" in line] == []
    held = [("xlo 0 ylo 0", "xlo 0 xhi 0.08 ylo 0"),
            ("fix sph all", "region end block 0.07 INF INF INF INF INF units box\n"
             "group end region end\ngroup moving subtract all end\nfix sph moving")]
    assert [line for line in advice(tmp_path / "held", held) if "ends at" in line] == []


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("type, body", [(1, 0), (2, 2)])
def test_created_twice(tmp_path, type, body, ranks):
    """What is at one place feels no force between, and whatever comes near feels twice."""
    again = DECK.replace("run 0",
                         f"create_atoms {type} region {'water' if type == 1 else 'plate'}\n"
                         "group plate type 2\ngroup old id <= 64\nset group all mol 0\n"
                         f"set group plate mol {body}\ngroup both intersect plate old\n"
                         "set group both mol 1\nrun 0")
    done = lammps(tmp_path, again, ranks)
    assert done.status != 0 and re.search(r"Fix fsi: atoms \d+ and \d+ are at the same place, .* "
                                          r"delete_atoms overlap", done.errors[0])


@pytest.mark.parametrize("dim, expected", [(2, 16), (3, 20)])
def test_what_artificial_viscosity_is_worth(tmp_path, dim, expected):
    """In the log, without a warning: alpha h c/4(d+2), and the Reynolds number with sqrt(2gH) and
    the water's 0.05 m."""
    text = DECK.replace("sound 12.53", "sound 12.53 artificial/visc 0.1 0")
    if dim == 3:
        text = text.replace("dimension 2", "dimension 3").replace("f f p", "f f f").replace(
            "lattice sq", "lattice sc").replace("create_atoms 2 region plate", "")
    output = run(tmp_path, text).output
    found = re.search(r"alpha 0.1, of type 1 acts like a kinematic viscosity of about (\S+): "
                      r"Reynolds number (\S+) with speed (\S+) and the fluid's least width (\S+)",
                      output)
    nu, reynolds, speed, width = map(float, found.groups())
    assert nu == pytest.approx(0.1 * 0.015 * 12.53 / expected, rel=0.05)
    assert speed == pytest.approx((2 * 9.81 * 0.08)**0.5, rel=0.01)
    assert (width == pytest.approx(0.05 if dim == 2 else 0.01, rel=0.01) and reynolds
            == pytest.approx(speed * width / nu, rel=0.06))


@pytest.mark.parametrize("held", [False, True])
def test_hourglass_of_a_free_body(tmp_path, held):
    """Forces of pair_style fsi/solid that turn with each particle: for bodies that are held."""
    text = DECK.replace("fsi/solid/tl\npair", "fsi/solid hourglass 0.1 gradient quadratic\npair")
    text = text.replace("fsi/solid/tl", "fsi/solid").replace(
        "timestep", "fix stress all fsi/stress\ntimestep")
    if held:
        text = text.replace("fix sph all", "region foot block INF INF INF 0.02 INF INF units box\n"
                            "group foot region foot\ngroup foot intersect foot plate\n"
                            "group moving subtract all foot\nfix sph moving")
    output = run(tmp_path, text, materials_fsi=MATERIALS.format(rho=1000, young=2e6)).output
    assert ("body 1 has no held particles: hourglass of pair_style" in output) != held


@pytest.mark.parametrize("change", [("timestep 4e-5", "fix dt all fsi/dt 1"),
                                    ("timestep 4e-5", "fix dt all fsi/dt 1 substeps auto")])
def test_chosen_time_step_is_not_criticized(tmp_path, change):
    assert advice(tmp_path, [change]) == []


def test_flow_driven_along_a_period_has_no_height(tmp_path):
    changes = [("boundary f f p", "boundary f p p"), ("-0.05 0.15 -0.005", "0 0.08 -0.005"),
               (" ylo 0", ""), ("sound 12.53", "sound 2")]
    assert advice(tmp_path, changes) == []


@pytest.mark.parametrize("group, weightless", [("all", False), ("water", True)])
def test_float_without_weight(tmp_path, group, weightless):
    """A rigid body of walls that fix rigid moves; one that nothing moves needs none."""
    float_ = [("create_atoms 2 region plate", "create_atoms 2 region plate\ngroup water type 1"),
              ("set group plate mol 1\n", ""), ("hybrid fsi/fluid", "fsi/fluid"),
              (" fsi/solid/tl\n", "\n"),
              ("pair_coeff * * fsi/fluid materials.fsi water_inviscid plate\n", "fsi/material buoy "
               "wall rho 500\npair_coeff * * materials.fsi water_inviscid buoy\n"),
              ("pair_coeff * * fsi/solid/tl materials.fsi NULL plate\n", ""),
              ("fix sph all", "fix sph water"),
              ("fix g all", f"fix w plate fsi/wall/particle\nfix g {group}")]
    rigid = [("run 0", "fix r plate rigid single force * on on off torque * off off on\nrun 0")]
    found = [line for line in advice(tmp_path / "rigid", [*float_, *rigid])
             if "weigh nothing" in line]
    assert len(found) == weightless and all(
        "24 moving particles of rigid bodies, the first of them atom 41" in line for line in found)
    assert advice(tmp_path / "held", float_) == []


@pytest.mark.parametrize("change", [("fix walls", "fix g all gravity 1 vector 0 -1 0\nfix walls"),
                                    ("sound 12.53", "sound 12.53 background 10 tension yes")],
                         ids=["weight", "tension"])
def test_stream_that_cannot_tear(tmp_path, change):
    torn, _, _ = CASES["torn stream"]
    assert advice(tmp_path, [*torn, change]) == []


def test_said_once(tmp_path):
    assert (len(advice(tmp_path, [("sound 12.53", "sound 5"), ("run 0", "run 0\nrun 1\nrun 1")]))
            == 1)
