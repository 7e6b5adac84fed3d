"""tools/run without its builds: which runs it makes of a scene, where they go, and what of it
survives a failure."""

import json
import re
import subprocess
from pathlib import Path

import pytest

from fsi import launch, paths, scene, suite
from fsi.summary import Summary

DECK = """# a deck that computes nothing
variable        dx index 0.1
variable        tend index 1.0
variable        rubber index soft
print           "FSI dx ${dx}"
"""
ANALYZE = """
import json
from pathlib import Path
from fsi.summary import Summary

def main(folder):
    summary = Summary(folder)
    if summary.log.values["dx"] > 1.0:
        raise ValueError("too coarse to analyze")
    summary.add("peak", 4.0 * summary.log.values["dx"], "mm", 4.0, "theory", target=0.05)
    summary.write()

def study(folder, runs):
    summary = Summary(folder)
    peaks = {name: json.loads((Path(path) / "summary.json").read_text())["figures"][0]["value"]
             for name, path in runs.items()}
    summary.add("change", peaks["fine"] - peaks["coarse"], "mm", target=1.0)
    summary.write()
"""
LOG = """LAMMPS (4 Feb 2025)
FSI dx {dx}
Per MPI rank memory allocation (min/avg/max) = 1 | 2 | 3 Mbytes
   Step         Time
         0   0
       {steps}   1
Loop time of {seconds} on {ranks} procs for {steps} steps with {atoms} atoms
"""
CASES = {"coarse": {"variables": {"dx": "0.5"}},
         "fine": {"variables": {"dx": 0.25, "rubber": "hard"}, "ranks": 3}}


@pytest.fixture
def examples(tmp_path, monkeypatch):
    """A folder of examples with one scene, `toy`, of two cases; LAMMPS is replaced by something
    that writes a log."""
    monkeypatch.setattr(paths, "EXAMPLES", tmp_path / "examples")
    monkeypatch.setattr(paths, "DRIVERS", tmp_path / "unittest")
    monkeypatch.setattr(paths, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(paths, "PAGE", tmp_path / "page")
    monkeypatch.setattr(scene, "build", lambda: True)
    monkeypatch.setattr(scene, "_simulate", simulate)
    make_scene(paths.EXAMPLES / "toy")
    return paths.EXAMPLES


def make_scene(folder, cases=CASES):
    """Writes a scene named as its folder."""
    folder.mkdir(parents=True)
    (folder / f"in.{folder.name}").write_text(DECK)
    (folder / "analyze.py").write_text(ANALYZE)
    if cases:
        (folder / "cases.json").write_text(json.dumps(cases))


def simulate(_, folder, ranks, variables):
    """In place of LAMMPS: 1/dx atoms, 10/dx steps, 1 s in the time loop; dx = 0 fails."""
    dx = float(variables.get("dx", 0.1))
    if dx == 0.0:
        return 1, 0.1, ["ERROR: no spacing"]
    (folder / "log.lammps").write_text(
        LOG.format(dx=dx, ranks=ranks, seconds=1.0, atoms=round(1 / dx), steps=round(10 / dx)))
    return 0, 2.0, []


def summary_of(*parts):
    return json.loads(paths.RESULTS.joinpath(*parts, "summary.json").read_text())


def figure(summary, name):
    return next(f for f in summary["figures"] if f["name"] == name)


def test_scene_without_variables_runs_all_cases(examples, capsys):
    assert scene.main(["toy"]) == 0
    assert summary_of("toy", "coarse")["variables"] == {"dx": "0.5", "tend": "1.0",
                                                        "rubber": "soft"}
    fine = summary_of("toy", "fine")
    assert (fine["ranks"], fine["given"], fine["case"]) == (3, {"dx": "0.25", "rubber": "hard"},
                                                            "fine")
    # 2 atoms and 20 steps, 4 atoms and 40 steps, each 1 s of time loop and 2 s in all
    study = summary_of("toy")
    assert figure(study, "change")["value"] == pytest.approx(-1.0)
    assert (study["particles"], study["steps"], study["cpu_seconds"],
            study["ranks"]) == (4, 60, 4.0, 3)
    assert study["particle_steps_per_second"] == pytest.approx((2 * 20 + 4 * 40) / 2.0)
    rank_seconds = 1 + 3  # one rank where a case does not say
    assert study["particle_steps_per_second_per_rank"] == pytest.approx(200.0 / rank_seconds)
    assert study["bytes_per_particle"] == pytest.approx(2 * 2**20 * 3 / 4)
    assert (study["lammps"], list(study["cases"]),
            study["failed_cases"]) == ("4 Feb 2025", ["coarse", "fine"], [])
    output = capsys.readouterr().out
    assert "case coarse (1 of 2)" in output and "case fine (2 of 2)" in output
    pages = [(paths.RESULTS / "toy" / place / "report.html").read_text()
             for place in ("", "coarse", "fine")]
    assert ("fine/report.html" in pages[0] and "change" in pages[0] and "rubber = hard" in pages[2]
            and "met" in pages[2])


def test_one_case(examples):
    assert scene.main(["toy", "case=fine", "ranks=1"]) == 0
    assert summary_of("toy", "fine")["ranks"] == 1
    assert not (paths.RESULTS / "toy" / "coarse").exists() and not (paths.RESULTS / "toy"
                                                                    / "summary.json").exists()


def test_own_variables_are_one_run_and_leave_the_cases_alone(examples, tmp_path):
    assert scene.main(["toy"]) == 0
    before = summary_of("toy")
    assert scene.main(["toy", "tend=2"]) == 0
    assert summary_of("toy", scene.OWN_RUN)["variables"] == {"dx": "0.1", "tend": "2",
                                                             "rubber": "soft"}
    assert summary_of("toy") == before
    assert scene.main(["toy", "tend=2", f"out={tmp_path / 'mine'}"]) == 0
    assert (tmp_path / "mine" / "summary.json").exists()


def test_scene_without_cases_is_one_run(examples):
    make_scene(examples / "single", cases=None)
    assert scene.main(["single"]) == 0
    assert summary_of("single")["figures"][0]["name"] == "peak"


@pytest.mark.parametrize("bad", ["0", "2"], ids=["simulation", "analysis"])
def test_failing_case_does_not_stop_the_others(examples, capsys, bad):
    cases = {"bad": {"variables": {"dx": bad}}, **CASES}
    (examples / "toy" / "cases.json").write_text(json.dumps(cases))
    assert scene.main(["toy"]) == 1
    study = summary_of("toy")
    assert (list(study["cases"]), study["failed_cases"]) == (["coarse", "fine"], ["bad"])
    assert "2 of 3 cases ran; failed: bad" in capsys.readouterr().out


def test_failing_study_is_reported_and_leaves_no_old_summary(examples):
    assert scene.main(["toy"]) == 0
    cases = {**CASES, "fine": {"variables": {"dx": "0"}}}
    (examples / "toy" / "cases.json").write_text(json.dumps(cases))
    assert scene.main(["toy"]) == 1  # the study needs the case that failed
    assert not (paths.RESULTS / "toy" / "summary.json").exists()
    assert not (paths.RESULTS / "toy" / "fine" / "summary.json").exists()
    assert (paths.RESULTS / "toy" / "coarse" / "summary.json").exists()


def test_files_of_others_stay(examples):
    assert scene.main(["toy"]) == 0
    notes = [paths.RESULTS / "toy" / "notes.txt", paths.RESULTS / "toy" / "fine" / "notes.txt"]
    for path in notes:
        path.write_text("mine")
    assert scene.main(["toy"]) == 0
    assert scene.main(["toy"]) == 0
    assert all(path.read_text() == "mine" for path in notes)


def test_all_goes_on_after_a_failure(examples, capsys):
    make_scene(examples / "bad", cases={"none": {"variables": {"dx": "0"}}})
    make_scene(examples / "single", cases=None)
    readme = (paths.ROOT / "README.md").read_text()
    assert scene.main(["all"]) == 1
    assert (paths.ROOT / "README.md").read_text() == readme
    assert figure(summary_of("toy"), "change") and summary_of("single")
    # as the cases say
    assert summary_of("toy", "coarse")["ranks"] == 1 and summary_of("toy", "fine")["ranks"] == 3
    assert "2 scenes ran, 1 failed bad" in capsys.readouterr().out
    assert not paths.PAGE.exists()  # pages are written by tools/renew alone
    assert re.fullmatch(r"\d{4}-\d\d-\d\d", summary_of("toy")["date"])


def test_all_goes_on_where_it_ended(examples, capsys, monkeypatch):
    """What is there of this commit is not run again; a case that is not there, was changed or has
    failed is."""
    monkeypatch.setattr(scene, "commit", lambda: "0123456789")
    make_scene(examples / "single", cases=None)
    assert scene.main(["all"]) == 0
    assert "some 0 left" in capsys.readouterr().out
    (paths.RESULTS / "toy" / "coarse" / "summary.json").unlink()
    (examples / "toy" / "cases.json").write_text(
        json.dumps({**CASES, "fine": {"variables": {"dx": 0.2}}}))
    assert scene.main(["all"]) == 0
    output = capsys.readouterr().out
    assert "1 of 3 runs are there" in output and figure(summary_of("toy"),
                                                        "change")["value"] == pytest.approx(-1.2)
    assert scene.main(["all"]) == 0 and "3 of 3 runs are there" in capsys.readouterr().out
    monkeypatch.setattr(scene, "commit", lambda: "0123456789+")
    assert scene.main(["all"]) == 0 and "runs are there" not in capsys.readouterr().out


@pytest.mark.parametrize("arguments, message", [
    (["toy", "case=fin"], "did you mean 'fine'"),
    (["toy", "case=fine", "dx=1"], "either"),
    (["toy", "ranks=0"], "ranks=0"),
    (["toy", "dx=small"], "number"),
    (["toy", "ten=1"], "did you mean 'tend'"),
    (["all", "case=fine"], "one scene"),
    (["all", "dx=1"], "one scene"),
])
def test_refusals_come_before_the_build(examples, monkeypatch, arguments, message):
    monkeypatch.setattr(scene, "build", lambda: pytest.fail("built"))
    with pytest.raises(scene.Refusal, match=message):
        scene.main(arguments)


@pytest.mark.parametrize("text, message", [
    ('{"a": {"variables": {"dy": 1}}}', "no variable 'dy'"),
    ('{"a/b": {"variables": {}}}', "name of a folder"),
    ('{"a": {"variables": {}, "ranks": "2"}}', "whole number"),
    ('{"a": 3}', "not of the form"),
    ("{", "not of the form"),
])
def test_bad_cases_are_refused(examples, text, message):
    (examples / "toy" / "cases.json").write_text(text)
    with pytest.raises(scene.Refusal, match=message):
        scene.main(["toy"])


def test_bundled_cases_are_sound():
    for name in scene.scenes():
        scene.cases(name)
        # tools/run could not set it
        assert not set(scene.OPTIONS) & set(scene.deck_variables(scene.deck(name)))


def test_cases_with_lammps(examples, monkeypatch):
    monkeypatch.undo()
    monkeypatch.setattr(paths, "EXAMPLES", examples)
    folder = examples.parent / "out"
    assert scene.run_cases("toy", folder, ranks=1) == 0
    study = json.loads((folder / "summary.json").read_text())
    assert figure(study, "change")["value"] == pytest.approx(-1.0)
    assert study["lammps"]


def test_target_of_a_figure(tmp_path):
    (tmp_path / "log.lammps").write_text("")
    summary = Summary(tmp_path)
    summary.add("near", 1.04, "mm", 1.0, "theory", target=0.05)
    summary.add("far", 0.94, "mm", 1.0, "theory", target=0.05)
    summary.add("small", -0.5, target=0.5)
    summary.add("large", -0.6, target=0.5)
    summary.add("lost", 3, "", 0, target=0)
    summary.add("missing", float("nan"), target=1.0)
    summary.add("without", 1.0)
    met = {f["name"]: f["met"] for f in summary.write()["figures"]}
    assert met["near"] and met["small"] and met["without"] is None
    assert [met[name] for name in ("far", "large", "lost", "missing")] == [False] * 4


def test_quick_leaves_out_what_is_slow(monkeypatch):
    asked = []
    monkeypatch.setattr(suite.subprocess, "run", lambda command, **_: asked.extend(command)
                        or suite.subprocess.CompletedProcess(command, 0))
    suite.pytest(suite.quick())
    collected = {Path(word).name for word in asked if word.startswith(str(paths.ROOT / "unittest"))}
    assert collected == {"styles"}
    assert f"--ignore={paths.ROOT / 'unittest/styles/test_fuzz.py'}" in asked


@pytest.mark.parametrize("tool", sorted(
    path.name for path in (paths.ROOT / "tools").iterdir() if not path.suffix))
def test_help_is_all_that_is_done(tool, tmp_path):
    """No tool installs or builds anything when it is asked what it does."""
    done = subprocess.run([paths.ROOT / "tools" / tool, "--help"], text=True, timeout=60,
                          env={**launch.environment(), "FSI_BUILD_DIR": str(tmp_path / "build")},
                          stdin=subprocess.DEVNULL, capture_output=True, check=False)
    assert done.returncode == 0 and (f"tools/{tool}" in done.stdout or tool == "pytest")
    assert not (tmp_path / "build").exists()
