"""The decks that users copy, examples/NAME/in.*: their form, and that they begin as the decks in
examples/NAME/study do."""

import re
import shutil
import subprocess

import numpy as np
import pytest

from fsi import check, launch, paths, scene

STARTERS = ("beam", "column", "droplet", "grains")  # one deck each, which tools/run takes, too
# so have these, without pictures of their own
ALONE = (*STARTERS, "cylinder_entry", "settling_disc", "sinking_square", "slump", "yield_channel",
         "yield_flap")
DECKS = {path.name.removeprefix("in."): path for path in sorted(paths.EXAMPLES.glob("*/in.*"))}
STUDIED = [name for name in DECKS if name not in ALONE]
LINES, COLUMNS = 45, 132
# options beside the first; else tend
MORE = {"slump": ["K", "shift", "tend"], "yield_channel": ["rows", "tend"]}
LONGER = {"flag_levels": 54, "turek_hron_fsi": 52}    # a cylinder and its flag
# no if, jump, label, next, print, quit, shell
PLAIN_COMMANDS = {
    "atom_style", "boundary", "comm_modify", "compute", "create_atoms", "create_box",
    "delete_atoms", "dimension", "displace_atoms", "dump", "dump_modify", "fix", "fsi/material",
    "fsi/clamp", "fsi/displace", "fsi/dump", "fsi/pack", "fsi/run", "fsi/set", "group", "include",
    "lattice", "neigh_modify", "neighbor", "pair_coeff",
    "pair_style", "region", "run", "set", "thermo", "thermo_modify", "thermo_style", "timestep",
    "unfix", "units", "variable", "velocity"}
DEFAULTS = ("newton on", "comm_modify mode single", "neigh_modify every 1 delay 0 check yes")
ORDER = ("units", "atom_style", "create_box", "lattice", "create_atoms", "pair_style", "pair_coeff",
         "fix 1 ", "thermo_style", ("dump 1 ", "fsi/dump "), ("run", "fsi/run"))

# what the deck of the study is given to be that of the plain deck, where that is not its default
GIVEN = {
    "flexible_plate": {"dx": 1 / 3},
    "plate_damping": {"mode": "paper", "n": 8, "alpha": 0.1},
    "poiseuille": {"flow": "poiseuille"},
    "rolling_tank": {"dx": 0.004 / 3},
    "section": {"dim": 2},
    "flag_levels": {"benchmark": "fsi2", "length": 1.5, "levels": 4, "coarse": 6.5, "mach": 20,
                    "shift": 0.125},
    "turek_hron_csm": {"across": 10},
    "turek_hron_fsi": {"benchmark": "fsi2", "length": 1.5, "finer": 2},
}
# of those with many particles; else 100
STEPS = {"cylinder_channel": 50, "cylinder_free": 10, "dam_break": 30, "dam_break_3d": 10,
         "dam_break_elastic": 3, "elastic_gate": 30, "flexible_plate": 3, "hydrostatic_plate": 10,
         "open_channel": 50, "plate_crossflow": 3, "ring_annulus": 10, "rolling_tank": 10,
         "sphere": 3, "taylor_bar": 30, "turek_hron_fsi": 50}
# what fix fsi warns of, in these decks alone
ADVICE = {"ring_annulus": "speed of sound 20", "flag_levels": "spacings apart",
          "submerged_plate": "on the other side of a body",
          "floating_flap": "on the other side of a body"}
STATE = "id xu yu zu vx vy vz modify format float %.17g"


def commands(name):
    """The deck's commands, each on one line with single blanks, without comments."""
    lines = re.sub(r"&\n", " ", DECKS[name].read_text()).splitlines()
    return [" ".join(words) for line in lines if (words := re.sub(r"#.*", "", line).split())]


@pytest.mark.parametrize("name", DECKS)
def test_form(name):
    lines, found = DECKS[name].read_text().splitlines(), commands(name)
    assert len(lines) <= LONGER.get(name, LINES)
    wide = [line for path in (DECKS[name], *DECKS[name].parent.glob("*.in"))
            for line in path.read_text().splitlines() if len(line) > COLUMNS]
    assert not wide or name in STARTERS
    assert lines[0].startswith("# ")
    assert {command.split()[0] for command in found} <= PLAIN_COMMANDS
    options = [command.split()[1] for command in found if re.match(r"variable \w+ index ", command)]
    assert len(options) == 1 or (name in ALONE and options[1:] == MORE.get(name, ["tend"]))
    styles = {command.split()[2] for command in found if command.startswith("variable ")}
    assert styles <= {"index", "equal", "atom"}
    assert not set(DEFAULTS) & set(found)
    places = [next(k for k, command in enumerate(found) if command.startswith(start) and command
                   != "run 0")
              for start in ORDER]
    assert places == sorted(places)
    dumps = sum(command.startswith(("dump ", "fsi/dump ")) for command in found)
    assert dumps == (2 if name in STARTERS else 1)  # starters draw, too
    assert any(re.match("thermo_style custom step .*cpuremain", command) for command in found)


def test_who_has_a_study():
    """What sweeps and tests take is the study's deck where there is one, and else the plain one."""
    for name in paths.examples():
        expected = name not in ALONE
        assert (scene.deck(name).parent.name == "study") == expected and scene.deck(name).is_file()
    studies = list(paths.EXAMPLES.glob("*/study/*"))
    assert len(studies) == len(set(paths.examples()) - set(ALONE))
    for path in studies:
        assert path.name == f"in.{path.parents[1].name}"


def begun(text, steps):
    """A deck that ends after some steps of its first run of any, and leaves its first and last
    state."""
    text = check.spelled_out(text)
    head, whole = re.split(r"^run +(?!0 )(\S+).*", text, maxsplit=1, flags=re.M)[:2]
    return (f'{head}print "WHOLE {whole} $(dt)"\nwrite_dump all custom first {STATE}\n'
            f"run {steps}\nwrite_dump all custom last {STATE}\n")


def states(folder, text, variables):
    """Runs a deck: (first state, last state, when the whole of it ends, advice that it gets).

    A state is places and velocities, the particles in the order of where they begin.
    """
    (folder / "in.deck").write_text(text)
    done = subprocess.run(launch.lammps("in.deck", 0, variables), cwd=folder,
                          env=launch.environment(), stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    first, last = (np.loadtxt(folder / name, skiprows=9) for name in ("first", "last"))
    first, last = (frame[np.argsort(frame[:, 0]), 1:] for frame in (first, last))
    order = np.lexsort(np.round(first[:, :3].T / np.ptp(first[:, :3]), 9))
    log = (folder / "log.lammps").read_text()
    stop = re.findall(r"^fix .* fsi/dt .*stop ([\d.e+-]+)", log, re.M)
    steps, dt = re.findall(r"^WHOLE (\S+) (\S+)$", log, re.M)[0]
    end = float(stop[0]) if stop else float(steps) * float(dt)
    return first[order], last[order], end, re.findall("^WARNING: Fix fsi.*", log, re.M)


def compare(name, folder, change=lambda text: text):
    """The plain deck, changed, and its study's: (differences, both ends, advice of the former).

    Differences: the largest of places over the extent and of velocities over the largest one, at
    the start and after some steps.
    """
    plain, study = DECKS[name], scene.deck(DECKS[name].parent.name)
    texts = [change(plain.read_text()), study.read_text()]
    if not re.search("^timestep", texts[0], re.M) and "fsi/dt" in texts[1]:
        # it is there to say how often to write; fix fsi/dt begins with a step of its own
        texts[1] = re.sub("^timestep.*", "", texts[1], flags=re.M)
    found = []
    for which, text, given in zip(("plain", "study"), texts, ({}, GIVEN.get(name, {}))):
        (folder / which).mkdir()
        for path in plain.parent.glob("*.in"):  # what the deck includes
            shutil.copy(path, folder / which)
        found.append(states(folder / which, begun(text, STEPS.get(name, 100)), given))
    (first, last, end, advice), (other_first, other_last, other_end, _) = found
    assert first.shape == other_first.shape
    extent, speed = np.ptp(first[:, :3]), np.abs(last[:, 3:]).max()
    assert np.abs(last[:, :3] - first[:, :3]).max() > 1e-8 * extent  # something happens
    differences = [np.abs(a - b)[:, some].max() / scale
                   for a, b in ((first, other_first), (last, other_last))
                   for some, scale in ((slice(3), extent), (slice(3, 6), speed))]
    return differences, (end, other_end), advice


@pytest.mark.parametrize("name", STUDIED)
def test_begins_as_the_study(tmp_path, name):
    """Both decks have one state at the start and after some steps, to round-off, and one end.

    Round-off: lists of neighbors are built at different times, so that sums have another order.
    Found were at most 5e-11 and, where all is nearly at rest, 6e-9 of the largest velocity.
    """
    differences, ends, advice = compare(name, tmp_path)
    assert max(differences[0], differences[2]) < 1e-9
    assert max(differences[1], differences[3]) < 1e-7
    assert ends[0] == pytest.approx(ends[1], rel=2e-3)
    assert all(ADVICE.get(name, "nothing") in line for line in advice)


@pytest.mark.parametrize("name, old, new", [
    ("elliptical_drop", "shift 0.5", "shift 0.49"),
    ("section", "artificial/visc 0.1 0", "artificial/visc 0.11 0"),
    ("turek_hron_csm", "hourglass 0", "hourglass 0.001"),
    ("submerged_plate", "equal 12*", "equal 12.1*")])
def test_sees_a_change(tmp_path, name, old, new):
    """One setting that is a little off shows."""
    differences, *_ = compare(name, tmp_path, lambda text: text.replace(old, new))
    assert differences[3] > 1e-6
