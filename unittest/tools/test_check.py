"""fsi check: advice without a step, in a copy that leaves the user's files alone."""

import re
import subprocess

import pytest

from fsi import check, cli, launch, log, paths
from fsi.command import Refusal

DECK = """variable dx index 0.01
variable n index 100
units si
dimension 2
boundary f f p
atom_style fsi
region box block 0 0.3 0 0.3 -0.005 0.005
create_box 1 box
lattice sq ${dx} origin 0.5 0.5 0
include bodies.in
pair_style fsi/fluid sound 20
pair_coeff * * materials.fsi water
fix sph all fsi ${dx} wendland 1.5
fix walls all fsi/wall/mirror ylo 0
fix g all gravity 9.81 vector 0 -1 0
timestep 1e-4
dump 1 all custom 10 mine.dump id x y
fix p all print 1 "$(step)" file mine.csv
run $n every 10 "print 'hello'" &
   post no
if "${n} > 5" then "run 50"
write_data out/mine.data
print "steps done: $(step)"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A deck with an include, outputs of an earlier run, and a folder to write into."""
    (tmp_path / "in.deck").write_text(DECK)
    (tmp_path / "bodies.in").write_text("region water block 0 0.1 0 0.1 INF INF units box\n"
                                        "create_atoms 1 region water\n")
    (tmp_path / "out").mkdir()
    for name in ("mine.dump", "mine.csv", "log.lammps", "out/mine.data"):
        (tmp_path / name).write_text("of an earlier run")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def says(capsys, *words):
    with pytest.raises(SystemExit) as stop:
        cli.main(["check", "in.deck", *words])
    return stop.value.code, capsys.readouterr().out


def test_sound_deck(folder, capsys):
    status, text = says(capsys)
    assert status == 0 and "100 particles, 100 steps; nothing to warn of" in text
    assert ("density of the fluid by continuity" in text and "2 mirror walls" not in text
            and "1 mirror wall" in text)
    assert all((folder / name).read_text() == "of an earlier run"
               for name in ("mine.dump", "mine.csv", "log.lammps", "out/mine.data"))
    assert sorted(path.name for path in folder.iterdir()) == ["bodies.in", "in.deck", "log.lammps",
                                                              "mine.csv", "mine.dump", "out"]


def test_runs_to_a_time(folder, capsys):
    """Not the steps that run was given, but the time of the stop, over the first step's limit: h/2c
    with h = 0.015, c = 20."""
    deck = (folder / "in.deck").read_text().replace("timestep 1e-4",
                                                    "fix dt all fsi/dt 1 stop 0.3").replace(
                                                        "run $n every 10", "run 1000000 every 10")
    (folder / "in.deck").write_text(deck)
    status, text = says(capsys)
    assert (status == 0 and f"100 particles, to t = 0.3 in {0.3 / (0.5 * 0.015 / 20):.2g} steps or "
            "more; nothing to warn of" in text)


@pytest.mark.parametrize("words", (["n=30"], ["-var", "n", "30"]))
def test_advice(words, folder, capsys):
    """A spacing that is not the lattice's; variables of the command line, in LAMMPS' form, too."""
    (folder / "in.deck").write_text(DECK.replace("fsi ${dx} wendland", "fsi 0.02 wendland"))
    status, text = says(capsys, *words)
    assert (status == 1 and "WARNING: Fix fsi" in text and "30 steps; " in text
            and "nothing to warn" not in text)


def test_warnings_of_lammps_are_told_but_are_no_advice(folder, capsys):
    (folder / "in.deck").write_text(
        DECK.replace("timestep 1e-4", "timestep 1e-4\nthermo_modify lost error\nthermo_style one"))
    status, text = says(capsys)
    assert (status == 0 and "WARNING: New thermo_style" in text
            and "nothing to warn of (and 1 of LAMMPS' own)" in text)


def test_bodies_are_measured(folder, capsys):
    """A region 2.6 spacings thick has 3 columns or 2: seen before the run. Of many bodies the first
    ones."""
    plate = ("fsi/material plate solid rho 1000 young 2e6 poisson 0.4\n"
             "pair_style hybrid fsi/fluid sound 20 fsi/solid/tl\n")
    plate += ("pair_coeff * * fsi/fluid materials.fsi water plate\n"
              "pair_coeff * * fsi/solid/tl materials.fsi NULL plate")
    deck = DECK.replace("create_box 1", "create_box 2").replace(
        "pair_style fsi/fluid sound 20\npair_coeff * * materials.fsi water", plate)
    (folder / "in.deck").write_text(deck)
    places = ("region plate{0} block 0.15 0.176 {1} {2} INF INF units box\ncreate_atoms 2 region "
              "plate{0}\ngroup plate{0} region plate{0}\nset group plate{0} mol {0}\n")
    (folder / "bodies.in").write_text("region water block 0 0.1 0 0.1 INF INF units box\n"
                                      "create_atoms 1 region water\n"
                                      + places.format(1, 0.05, 0.15))
    _, text = says(capsys)
    assert "fsi check: body 1: 30 particles, 3 x 10 spacings of 0.01\n" in text and not list(
        folder.glob("fsi_check*"))
    (folder / "bodies.in").write_text("".join(places.format(k, 0.04 * k - 0.04, 0.04 * k - 0.01)
                                              for k in range(1, 8)))
    _, text = says(capsys)
    assert text.count("spacings of 0.01") == 6 and "fsi check: and 1 more\n" in text


@pytest.mark.parametrize("loop", ['run 100\nif "$(step) < 1000" then "jump SELF again"',
                                  'if "$(step) < 1000" then "run 100" "jump SELF again"'])
def test_loop_until_a_step(folder, capsys, loop):
    """It ends, though no run reaches that step."""
    (folder / "in.deck").write_text(DECK.replace('if "${n} > 5" then', f"label again\n{loop}\nif"
                                                 ' "${n} > 5" then'))
    status, text = says(capsys)
    assert status == 0 and f"only the first {check.MOST} runs" in text


def test_no_step_is_computed(folder):
    status, output, *_ = check.run("in.deck", {})
    assert status == 0 and "steps done: 0" in output


@pytest.mark.parametrize("name, given", [("droplet", "tend=0.1"), ("column", "tend=0.08")])
def test_estimate(tmp_path, monkeypatch, capsys, name, given):
    """CPU time within a factor of 2 of that of the whole run, and LAMMPS' own count of memory."""
    deck = paths.EXAMPLES / name / f"in.{name}"
    (tmp_path / "in.deck").write_text(deck.read_text())
    monkeypatch.chdir(tmp_path)
    _, text = says(capsys, given)
    guess, unit, memory = re.search(
        r"about (\d+) (s|min) of CPU time on one rank.*; arrays of (\d+) MB", text).groups()
    key, value = given.split("=")
    subprocess.run(launch.lammps("in.deck", 0, {key: value}), env=launch.environment(),
                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, timeout=500, check=True)
    runs = log.read("log.lammps").finished
    seconds = sum(run.cpu_seconds for run in runs)
    print(name, guess, unit, seconds)
    assert 0.5 * seconds - 0.5 < float(guess) * (60 if unit == "min" else 1) < 2 * seconds + 0.5
    assert float(memory) == pytest.approx(max(run.bytes_per_rank for run in runs) / 1e6, abs=2)


def test_several_runs():
    """Of each the CPU time of a step times its steps; where the time ends a run, those up to it."""
    text = """fix dt all fsi/dt 1 stop 0.3
FSI steps 1000000
Loop time of 2
FSI dt 1e-3
fix dt all fsi/dt 1 stop 0.4
FSI steps 1000000
Loop time of 4
FSI dt 2e-3
"""
    found = log.Log(runs=[log.Run(loop_seconds=2.0, cpu_use=0.5, steps=10),
                          log.Run(loop_seconds=4.0, cpu_use=0.5, steps=10)], values={}, warnings=[],
                    errors=[])
    assert check.estimate(found, text) == pytest.approx(0.1 * 300 + 0.2 * 50)
    assert check.estimate(found,
                          text.replace("stop", "max")) == pytest.approx(0.1 * 1e6 + 0.2 * 1e6)
    assert check.estimate(found, text.replace("stop", "max").replace("FSI steps", "none")) is None


def test_deck_that_does_not_run(folder, capsys):
    (folder / "bodies.in").write_text("create_atoms 2 region water\n")
    status, text = says(capsys)
    assert status == 1 and "ERROR" in text and "does not run" in text
    (folder / "in.deck").write_text(DECK + "nonsense\n")
    (folder / "bodies.in").write_text("create_atoms 1 single 0.1 0.1 0\n")
    status, text = says(capsys)
    assert (status == 1 and "Unknown command" in text
            and "fails after 2 of its runs were set up" in text)


def test_what_a_deck_may_read(folder):
    """Included decks and files that are named, with variables; not what is written."""
    (folder / "shape_0.01.data").write_text("")
    (folder / "more.in").write_text("read_data shape_${dx}.data add append\nread_data "
                                    "other_${unknown}.data\nmolecule m body.mol # not.this\n")
    for name in ("other_7.data", "body.mol", "not.this"):
        (folder / name).write_text("")
    (folder / "in.deck").write_text(DECK + "include more.in\n")
    files, decks = check.inputs(folder / "in.deck", {"n": "1"}, folder)
    assert {path.name for path in files} == {"bodies.in", "more.in", "shape_0.01.data",
                                             "other_7.data", "body.mol"}
    assert {path.name for path in decks} == {"in.deck", "bodies.in", "more.in"}


def test_other_places(folder, capsys, monkeypatch):
    """What is read from the folder above and from names with spaces; outputs with absolute paths,
    in that folder and by fsi/dump, which are as they were; a log of another name."""
    (folder / "a b.data").write_text((folder / "bodies.in").read_text())
    (folder / "here").mkdir()
    monkeypatch.chdir(folder / "here")
    deck = (folder / "in.deck").read_text().replace("include bodies.in", 'include "../a b.data"')
    deck = deck.replace("mine.dump", f"{folder}/mine.dump").replace(
        "file mine.csv", "file ${where}/mine.csv").replace("out/mine.data", "../out/mine.data")
    (folder / "here/in.deck").write_text(f"variable where index {folder}\nlog my.log\n" + deck)
    status, text = says(capsys)
    assert status == 0 and "100 particles, 100 steps; nothing to warn of" in text, text
    assert all((folder / name).read_text() == "of an earlier run"
               for name in ("mine.dump", "mine.csv", "out/mine.data"))
    (folder / "here/big.dump").write_text("")
    (folder / "here/in.deck").write_text("fsi/dump all 0.1 p file big.dump\n")
    assert check.inputs(folder / "here/in.deck", {}, folder / "here")[0] == set()


def test_no_deck_and_no_lammps(folder, monkeypatch):
    with pytest.raises(SystemExit, match="none is not a file|none.in is not a file"):
        cli.main(["check", "none.in"])
    monkeypatch.setattr(check.paths, "BUILD", folder / "nowhere")
    monkeypatch.setenv("PATH", str(folder))
    with pytest.raises(Refusal, match="there is no LAMMPS"):
        check.lammps()
