"""tools/renew: pages are what the data in doc make of them, data name commit and date, and what is
collected and what is refused."""

import json
import re
import shutil
import sys

import pytest

from fsi import gallery, paths, results, scene
from fsi.command import Refusal

sys.path.insert(0, str(paths.ROOT / "bench"))
import cost_report  # noqa: E402
import effects  # noqa: E402
import evidence  # noqa: E402
import hard_pages  # noqa: E402
import renew  # noqa: E402
from tool import read_csv, write_csv  # noqa: E402

DATA = [path for folder in ("cost", "hard") for end in ("csv", "json")
        for path in sorted((paths.ROOT / "doc" / folder).glob(f"*.{end}"))]
PAGES = renew.texts()
MEASURED = [path for path in PAGES if path.suffix == ".md"
            and path.is_relative_to(paths.ROOT / "doc")]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.relative_to(paths.ROOT).as_posix())
def test_page_is_what_the_data_make_of_it(page):
    """Whoever changes data, or a page by hand, runs tools/renew --pages-only."""
    assert page.read_text(encoding="utf-8") == PAGES[page]


@pytest.mark.parametrize("page", MEASURED, ids=lambda path: path.relative_to(paths.ROOT).as_posix())
def test_page_has_one_picture_and_one_table(page):
    text = PAGES[page]
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    assert len(pictures) == 1 and all((page.parent / name).is_file() for name in pictures)
    hard = page == evidence.HARD / "README.md"  # a line for each bound, tests of the software apart
    assert len(re.findall(r"^\|(?: ?---?-?:? ?\|)+$|^\|[-: |]+\|$", text, re.M)) == (
        2 if hard or page.parent.name == "results" else 1)
    assert len(text.splitlines()) <= (250 if page.parent.name == "results" else 110 if hard else 80)


def test_no_page_that_is_not_written():
    """In the folders of measured pages."""
    found = {page for folder in ("cost", "hard", "results")
             for page in (paths.ROOT / "doc" / folder).glob("*.md")}
    assert found == set(MEASURED)


@pytest.mark.parametrize("path", DATA, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_data_name_their_commit_and_date(path):
    """One without changes beside it: who reads a number can go back to what gave it."""
    assert renew.stamp(path)


def test_results_name_their_commit_and_date():
    found = results.scenes_of(paths.PAGE)
    assert len(found) > 30
    for name, entry in found.items():
        assert re.fullmatch(r"[0-9a-f]{10}", entry["summary"]["commit"]) and re.fullmatch(
            r"\d{4}-\d\d-\d\d", entry["summary"]["date"]), name


def test_a_table_keeps_its_values(tmp_path):
    rows = [{"a": 1.23456, "b": "x, y", "c": None, "d": True}, {"a": 2, "b": "z", "d": False}]
    write_csv(tmp_path / "a.csv", "tools/cost a", ("a", "b", "c", "d"), rows, 3)
    assert read_csv(tmp_path / "a.csv") == [{"a": 1.23, "b": "x, y", "c": None, "d": True},
                                            {"a": 2.0, "b": "z", "c": None, "d": False}]
    assert re.match(r"# tools/cost a; commit \S+, \d{4}-\d\d-\d\d\na,b,c,d\n",
                    (tmp_path / "a.csv").read_text())


@pytest.fixture
def runs(tmp_path, monkeypatch):
    """What a whole set of runs leaves in results: the data of doc, as of one commit; and folders
    for what is collected."""
    made = tmp_path / "results"
    for name in renew.sweeps():
        (made / "cost" / name).mkdir(parents=True)
        shutil.copyfile(renew.PAGE / f"{name}.csv", made / "cost" / name / "points.csv")
        shutil.copyfile(renew.PAGE / f"{name}.json", made / "cost" / name / "summary.json")
    for name, source in [*((name, renew.PAGE) for name in renew.TOOLS),
                         ("robustness", evidence.HARD)]:
        (made / "cost" / name).mkdir(parents=True)
        shutil.copyfile(source / f"{name}.csv", made / "cost" / name / f"{name}.csv")
    for name, entry in results.scenes_of(paths.PAGE).items():
        (made / name).mkdir(parents=True, exist_ok=True)
        (made / name / "summary.json").write_text(
            json.dumps({**entry["summary"], "commit": "0123456789"}))
    for name in ("hard.json", "hard.csv", "thumbnails.png"):
        shutil.copyfile(evidence.HARD / name, made / "hard" / name)
    examples = tmp_path / "examples"
    for name in paths.examples():
        (examples / name).mkdir(parents=True)
        for file in ("README.md", f"in.{name}"):
            shutil.copyfile(paths.EXAMPLES / name / file, examples / name / file)
        (examples / name / "cost.json").touch() if name in renew.sweeps() else None
    for module, name, path in ((paths, "ROOT", tmp_path), (paths, "RESULTS", made),
                               (paths, "EXAMPLES", examples),
                               (paths, "PAGE", tmp_path / "doc/results"),
                               (renew, "PAGE", tmp_path / "doc/cost"),
                               (evidence, "HARD", tmp_path / "doc/hard")):
        monkeypatch.setattr(module, name, path)
        if path.parent.name == "doc":
            path.mkdir(parents=True)
    return tmp_path


def test_collects_data_and_pictures(runs):
    root = paths.Path(__file__).resolve().parents[2]
    (paths.RESULTS / "beam" / "tip.png").write_text("of the beam")
    picture = gallery.pictures("elastic_gate")[0][1]
    for case, text in (("10MPa_3_across", "small"), ("10MPa_5_across", "large")):
        (paths.RESULTS / "elastic_gate" / case).mkdir()
        (paths.RESULTS / "elastic_gate" / case / picture).write_text(text)
    renew.collect()
    for path in (path for path in DATA if path.stem != "largest"):  # taken by name alone
        assert (runs / path.relative_to(root)).read_bytes() == path.read_bytes(), path
    assert {entry["summary"]["commit"] for entry in results.scenes_of(paths.PAGE).values()
            if entry["summary"]} == {"0123456789"}
    # where the study left none, the largest case's
    assert (paths.EXAMPLES / "elastic_gate" / picture).read_text() == "large"
    shown = [file for _, file in gallery.pictures("beam")]
    assert (paths.EXAMPLES / "beam" / "tip.png").exists() == ("tip.png" in shown)


@pytest.mark.parametrize("spoil, says", [
    (lambda made: (made / "cost/effects/effects.csv").unlink(),
     r"results/cost/effects/effects.csv: not there"),
    (lambda made: (made / "cost/peers/peers.csv").write_text(
        "# tools/cost peers; commit 0123456789+, 2026-11-24\na\n"), "peers.csv: of no commit"),
    (lambda made: (made / "cost/peers/peers.csv").write_text("a\n1\n"), "peers.csv: of no commit"),
    (lambda made: (made / "beam/summary.json").write_text(
        json.dumps({"commit": "abc", "figures": []})), "pages are of one commit")])
def test_what_is_not_whole_is_refused(runs, spoil, says):
    spoil(paths.RESULTS)
    with pytest.raises(Refusal, match=says):
        renew.collect()
    assert not list(runs.glob("doc/*/*"))


def test_takes_one_table(runs):
    """A table of tools/cost alone; all else stays."""
    renew.collect()
    before = {path: path.read_bytes() for path in runs.glob("doc/*/*")}
    path = paths.RESULTS / "cost/peers/peers.csv"
    path.write_text(path.read_text() + "another row\n")
    renew.take(["cost/peers"])
    changed = {path.name for path, text in before.items() if path.read_bytes() != text}
    assert changed == {"peers.csv"} and (renew.PAGE / "peers.csv").read_text().endswith(
        "another row\n")


def test_takes_one_scene(runs):
    """It is replaced; all others stay."""
    renew.collect()
    before = results.scenes_of(paths.PAGE)
    path = paths.RESULTS / "beam/summary.json"
    path.write_text(
        json.dumps({**json.loads(path.read_text()), "commit": "abcdef0123", "steps": 7}))
    renew.take(["beam"])
    after = results.scenes_of(paths.PAGE)
    assert after["beam"]["summary"] == {**before["beam"]["summary"], "commit": "abcdef0123",
                                        "steps": 7}
    assert {k: v for k, v in after.items() if k != "beam"} == {k: v for k, v in before.items()
                                                               if k != "beam"}


@pytest.mark.parametrize("wanted, says",
                         [("beam/none", "neither a scene"), ("nonsense", "neither a scene"),
                          ("cost/beam", "neither a scene"), ("droplet", "of no commit")])
def test_what_cannot_be_taken_is_refused(runs, wanted, says):
    renew.collect()
    path = paths.RESULTS / "droplet/summary.json"
    path.write_text(path.read_text().replace("0123456789", "0123456789+"))
    with pytest.raises(Refusal, match=says):
        renew.take([wanted])


def test_changes_are_refused_before_a_run(monkeypatch):
    monkeypatch.setattr(scene, "main", lambda _: pytest.fail("ran"))
    for commit in ("0123456789+", None):
        monkeypatch.setattr(scene, "commit", lambda c=commit: c)
        with pytest.raises(Refusal, match="the tree has changes"):
            renew.main([])


def test_runs_are_all_and_a_failure_is_told(monkeypatch, capsys):
    """Every scene, every sweep, every comparison; pages are written all the same."""
    ran = []
    monkeypatch.setattr(scene, "commit", lambda: "0123456789")
    monkeypatch.setattr(scene, "main", lambda words: ran.append(tuple(words)))
    monkeypatch.setattr(renew.accuracy_cost, "main", lambda words: ran.append(tuple(words)))
    for name, program in {**renew.TOOLS, "robustness": renew.robustness}.items():
        monkeypatch.setattr(program, "main", lambda words, n=name: ran.append((n, *words))
                            or int(n == "peers"))
    done = []
    for step in ("collect", "draw"):
        monkeypatch.setattr(renew, step, lambda s=step: done.append(s))
    monkeypatch.setattr(renew, "texts", lambda: {})
    assert renew.main([]) == 1 and done == ["collect", "draw"]
    assert ran == [("all",), *((name,) for name in renew.sweeps()),
                   *((name,) for name in renew.TOOLS), ("robustness",)]
    assert "renew: failed: tools/cost peers" in capsys.readouterr().err
    del ran[:], done[:]
    assert renew.main(["--no-runs"]) == 0 and done == ["collect", "draw"] and not ran
    assert renew.main(["--pages-only"]) == 0 and done == ["collect", "draw", "draw"]


@pytest.mark.parametrize("words",
                         [["nonsense"], ["--no-runs", "--pages-only"], ["x=1"], ["--only"]])
def test_nonsense_is_refused(words, monkeypatch):
    monkeypatch.setattr(renew, "draw", lambda: pytest.fail("drew"))
    with pytest.raises(Refusal, match="is not one of"):
        renew.main(words)


# ---- hard cases ----

def test_hard_page_says_what_the_data_say():
    found = json.loads((evidence.HARD / "hard.json").read_text())
    assert {e["row"]: e["case"] for e in found["rows"]} == {
        name: row.title for name, row in scene.analysis("hard").ROWS.items()}
    text = hard_pages.hard_page()
    scores = [[e[r]["pass"] for e in found["rows"] if e["scheme"] and r in e]
              for r in ("best", "delta", "classic")]
    assert "**{} hard cases pass here, {} with delta-SPH, {} with classic SPH.**".format(
        *(f"{sum(s)} of {len(s)}" for s in scores)) in text
    table = [line.strip("| ").split(" | ") for line in text.splitlines() if line.count("|")
             == 7][2:]
    assert len(table) == sum(len(e["bounds"]) for e in found["rows"] if e["scheme"])
    marks = iter(row[-3] for row in table)
    for e in found["rows"]:
        if e["scheme"]:
            assert (all([next(marks).endswith("✓") for _ in e["bounds"]])
                    == e["best"]["pass"]), e["row"]
    readme = (paths.folder("hard") / "README.md").read_text()
    assert all(f"| `{recipe}` | {sum(s)} of {len(s)} |" in readme
               for recipe, s in zip(evidence.RECIPES, scores))
    # messages are in the table of all runs
    assert "Mach number" not in text and len(evidence.unstable()) == 4
    assert any("Mach number" in (row["stopped"] or "")
               for row in read_csv(evidence.HARD / "hard.csv"))


def test_robustness_counts_its_table():
    rows = read_csv(evidence.HARD / "robustness.csv")
    sound = sum(r["verdict"] == "sound" for r in rows)
    assert f" {sound} of {len(rows)} scenes start soundly" in hard_pages.robust()
    # a wall that does not move has no material that could matter
    assert not [r for r in rows if r["scene"] in renew.robustness.HELD
                and not r["change"].startswith(("as it is", "spacing"))]


# ---- the three questions ----

def test_effects_of_each_type_are_those_of_its_log():
    """Every effect is named by some type and by none that the log has off; numbers are those of the
    table."""
    rows = {kind: added for kind, added, _ in evidence.matrix()}
    assert len(rows) == 9 and len(evidence.EFFECTS) == 12
    assert {effect for added in rows.values() for effect in added} == set(evidence.EFFECTS)
    measured = {(r["scene"], r["effect"]): r["instructions"]
                for r in read_csv(evidence.PAGE / "effects.csv")}
    assert rows["dam break"] == {"artificial viscosity": measured["fluid", "artificial viscosity"],
                                 "density diffusion": measured["fluid", "density diffusion"],
                                 "mirror walls": measured["fluid", "mirror walls"]}
    assert (rows["flow past a rigid body"]["particle shifting"]
            == measured["fluid", "shifting, every 4 steps"])
    assert rows["vortices without walls"]["particle shifting"] == measured["fluid", "shifting"]
    assert rows["water on an elastic body"]["solid sub-steps"] == measured["gate", "sub-steps"]
    assert rows["water on an elastic body"]["coupling with solids"] is None
    known = {(name, effect) for name in effects.SCENES for effect, *_ in effects.cases(name)}
    assert {(table, name) for _, by in evidence.EFFECTS.values()
            for table, name in by.items()} <= known


def test_methods_that_are_compared_were_run():
    for name, methods in evidence.COMPARED.items():
        summary = evidence.summaries()[name]
        assert all(curve for curve, _ in evidence.curves_in(name, summary)), name
        assert {method for method, _ in methods} <= set(summary["methods"])


def test_sentences_have_the_numbers_of_the_data():
    """Against the tables, read anew."""
    said = "\n".join(evidence.sentences())
    error = {(name, r["group"], r["x"]): 100 * abs(r["error"]) for name in evidence.COMPARED
             for r in read_csv(evidence.PAGE / f"{name}.csv")
             if r["role"] == "curve" and r["error"] is not None}
    plates = [[error[name, method, n] for name, method in methods for n in (3, 4, 5)]
              for methods in ((("oscillating_plate", "TL quadratic, clamp at the face"),
                               ("hydrostatic_plate", "splash")),
                              (("oscillating_plate", "delta-SPH"),
                               ("hydrostatic_plate", "delta-SPH")))]
    bound, = re.findall(r"are within ([\d.]+) %", said)
    assert (0 <= float(bound) - max(plates[0]) < 0.1
            and f"the same plates are {min(plates[1]):.0f} to {max(plates[1]):.0f} % off" in said)
    ratios = [error["taylor_green", "no shifting, quintic 1.0", x]
              / error["taylor_green", "shifting, quintic 1.0", x] for x in (0.05, 0.02)]
    assert "{:.0f} to {:.0f} times".format(*ratios) in said
    for size in (0.05, 0.0166666666667):
        assert (f"{error['standing_wave', 'quintic 1.0', size]:.2g} % here and "
                f"{error['standing_wave', 'delta-SPH', size]:.2g} % with delta-SPH" in said)
    assert (f"{error['taylor_green', 'shifting, quintic 1.0', 0.02]:.2g} % here and "
            f"{error['taylor_green', 'shifting, Wendland 1.5', 0.02]:.2g} %" in said)
    one = [100 * abs(r["error"]) for r in read_csv(evidence.PAGE / "turek_hron_fsi.csv")
           if r["error"] is not None and not r["label"].startswith("four")]
    one += [100 * abs(r["value"] / 81.6 - 1) for r in read_csv(evidence.PAGE / "sound.csv")
            if r["figure"] == "uy_amplitude"]
    scene_of_flag = results.scenes_of(paths.PAGE)["turek_hron_fsi"]
    (amplitude,) = (f["value"] / f["reference"] - 1 for f in scene_of_flag["summary"]["figures"]
                    if f["name"] == "uy_amplitude_fsi2_2_to_8")
    assert (f"is {min(one):.0f} to {max(one):.0f} % off" in said
            and f"bring it to {100 * abs(amplitude):.1f} %" in said)


def test_what_is_not_accurate_has_the_numbers_of_the_data():
    """Against the tables, read anew: the gate of two particles, and the coarsest updated-Lagrangian
    plate that ends."""
    error, ended = ({(name, r["group"], r["x"]): r[key]
                     for name in ("elastic_gate", "oscillating_plate")
                     for r in read_csv(evidence.PAGE / f"{name}.csv")
                     if r["role"] == "curve"} for key in ("error", "status"))
    said = evidence.unstable()
    bends = round(-100 * error["elastic_gate", "TL", 0.0025])
    assert f"the gate bends {bends} % too little" in said[0]
    plate = {x: status for (name, method, x), status in ended.items() if (name, method)
             == ("oscillating_plate", "UL quadratic, hourglass, clamp at the face")}
    fewest = re.search(r"the elastic plate with fewer than (\d+) particles", said[3])[1]
    assert {status for x, status in plate.items()
            if x < int(fewest)} == {"failed"} and plate[int(fewest)] == "ok"


def test_evidence_answers_each_question_once():
    text = evidence.page()
    assert text.count(".. image::") == 3 and text.count("\n---") == 3
    assert "unittest/tools/test_pay.py" in text and (paths.ROOT
                                                     / "unittest/tools/test_pay.py").exists()
