"""Figures of all scenes: what is collected, the page, the README's table and the picture, made of a
made-up folder of results."""

import copy
import csv
import io
import json

import pytest

from fsi import paths, results
from fsi.command import Refusal

COST = {"particles": 1234, "steps": 10, "ranks": 2, "cpu_seconds": 12.34,
        "particle_steps_per_second": 1e6,
        "particle_steps_per_second_per_rank": 5e5, "bytes_per_particle": 800.0,
        "lammps": "4 Feb 2025", "commit": "abcdef0123", "date": "2026-11-24"}


def figure(name, value, unit="", reference=None, source=None, target=None, met=None, error=None):
    return {"name": name, "value": value, "unit": unit, "reference": reference, "source": source,
            "target": target,
            "met": met, "relative_error": error}


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """Three scenes: `stone`, one run; `study`, two cases and one that failed; `lost`, without
    results."""
    monkeypatch.setattr(paths, "EXAMPLES", tmp_path / "examples")
    monkeypatch.setattr(paths, "DRIVERS", tmp_path / "unittest")
    for name, text in (("stone", "# Falling stone\n\nA stone falls.\n"),
                       ("study", "# Study | stones\n\nMany.\n"), ("lost", "# Lost\n\nNo stone.\n")):
        folder = paths.EXAMPLES / name
        folder.mkdir(parents=True)
        (folder / f"in.{name}").write_text("")
        (folder / "README.md").write_text(text)
    stone = {"scene": "stone", "given": {"dx": "2"}, **COST, "figures": [
        figure("speed", 11.0, "m/s", 10.0, "experiment, A | B 1999", 0.05, False, 0.1),
        figure("time", 1.01, "s", 1.0, "theory", 0.05, True, 0.01),
        figure("lost", 0, "", None, None, 0, True),
        figure("height", 1.2, "m", 1.0, "our own run", 0.5, True, 0.2),
        figure("colour", None, "nm"), figure("cpu_seconds", 12.34, "s")]}
    study = {"scene": "study", **COST, "failed_cases": ["wide"],
             "cases": {"small": {"particles": 10, "cpu_seconds": 1.0, "ranks": 1},
                       "large": {"particles": 1234, "cpu_seconds": 200.0, "ranks": 3}},
             "figures": [figure("order", 1.98, "", 2.0, "theory: a line", None, None, -0.01),
                         figure("slope", 1.9, "", 2.0, "the same", 0.1, True, -0.05)]}
    for name, summary in (("stone", stone), ("study", study)):
        folder = tmp_path / "results" / name
        folder.mkdir(parents=True)
        (folder / "summary.json").write_text(json.dumps(summary))
    return tmp_path


@pytest.fixture
def found(tree):
    return results.collect(tree / "results")


def test_head_says_what_is_met_and_what_failed(found):
    head = results.render(found).split("| scene |")[0]
    assert "with a reference from outside, 2 of 3 are met.**" in head  # speed, time, slope
    assert ("by a run of this package 1 of 1 are met, of self-checks without a reference 1 of "
            "1." in head)
    assert "**Failed, in part or as a whole: lost, study.**" in head
    # 2 * 12.34 + 1 + 3 * 200 s
    assert "All 2 scenes and the hard cases together take 0.2 hours on one core." in head
    assert ("All 7 figures are in [results.csv](results.csv), with the 1 self-checks that are "
            "met." in head)
    assert head.count("![") == 1


def test_table(found):
    page = results.render(found)
    assert ("| [Falling stone](../../examples/stone/README.md) | `speed` | 11\u00a0m/s | 10 | "
            "experiment | +10.0\u00a0% | 5 % | **no** | 25 |" in page)
    assert "|  | `time` | 1.01\u00a0s | 1 | theory | +1.0\u00a0% | 5 % | yes |  |" in page
    assert ("|  | `height` | 1.2\u00a0m | 1 | own run | +20.0\u00a0% | 50 % | yes |  |" in page
            and "`lost`" not in page)
    missed = copy.deepcopy(found)
    missed["scenes"]["stone"]["summary"]["figures"][2] |= {"value": 1, "met": False}
    assert "|  | `lost` | 1 |  | none |  | 0 | **no** |  |" in results.render(missed)
    assert ("| [Study \\| stones](../../examples/study/README.md) | `slope` | 1.9 | 2 | theory | "
            "-5.0\u00a0% | 10 % | yes | 601 |" in page)
    # no target: a line for each source; neither: in the table of all figures; what a run costs: in
    # neither
    assert ("| [Study \\| stones](../../examples/study/README.md) | theory: a line | 1 | "
            "1.0\u00a0% | -1.0 % (`order`) |" in page)
    assert "`colour`" not in page and "`cpu_seconds`" not in page
    rows = list(csv.DictReader(io.StringIO(results.table(found))))
    assert [row["figure"] for row in rows] == ["speed", "time", "lost", "height", "colour", "order",
                                               "slope"]
    assert [row["kind"] for row in rows] == ["experiment", "theory", "", "own run", "", "theory",
                                             "theory"]
    assert rows[0] == {"scene": "stone", "figure": "speed", "value": "11", "unit": "m/s",
                       "reference": "10", "kind": "experiment", "source": "experiment, A | B 1999",
                       "error_percent": "10", "target": "0.05", "met": "False",
                       "commit": "abcdef0123", "date": "2026-11-24"}


def test_a_scene_without_references_and_targets_has_a_line(found):
    found["scenes"]["stone"]["summary"]["figures"] = [figure("a", 1.0), figure("b", 2.0),
                                                      figure("cpu_seconds", 3.0)]
    assert "| [Falling stone](../../examples/stone/README.md) | none | 2 |  |  |" in results.render(
        found)


def test_kinds():
    """The kind stands first; what has none is refused, not counted as one from outside."""
    sources = (None, "code, finite elements, X", "2D finite elements", "our own 2D run",
               "codes: middle", "beam theory: y", "finite differences", "mean over the last 0.5 s")
    assert [results.kind(source) for source in sources] == [
        None, "finite elements", "finite elements", "own run", "code", "theory", "theory", None]
    with pytest.raises(Refusal, match="'somebody' begins with none of the kinds"):
        results.kind("somebody")


def test_every_source_of_the_results_has_a_kind():
    """Of each figure with a reference, and of each with a target and a source."""
    for entry in results.ran({"scenes": results.scenes_of(paths.PAGE)}).values():
        assert not [f["name"] for f in entry["summary"]["figures"]
                    if (f["reference"] is not None or f["target"] is not None and f["source"])
                    and not results.kind(f["source"])]


def test_errors_are_positive_where_sizes_are_too_large(found):
    found["scenes"]["stone"]["summary"]["figures"][0] |= {"value": -11.0, "reference": -10.0,
                                                          "relative_error": -0.1}
    assert "| -10 | experiment | +10.0\u00a0% |" in results.render(found)


MAIN = {"both": {"stone": [{"figure": "speed", "words": "how fast"}], "study": [
    {"title": "How steep", "figure": "slope", "words": "slope", "of": "slope", "case": "large"},
                                                                               {"figure": "gone",
                                                                                "words": "x"}]},
        "other": {"lost": [{"figure": "x", "words": "y"}]}}


def test_headlines(found, monkeypatch):
    """The README's table: the declared quantity, and of the other judged ones that with the largest
    error, a run of our own included."""
    monkeypatch.setattr(results, "main_figures", lambda: MAIN)
    with_other = copy.deepcopy(MAIN)
    text = results.readme(f"# Title\n{results.MARKS[0]}old\n{results.MARKS[1]}## Rest\n", found)
    assert text.startswith("# Title\n") and text.endswith("## Rest\n") and "old" not in text
    assert ("| [Falling stone](examples/stone/README.md) | how fast 11\u00a0m/s | 10 (experiment) "
            "| +10.0\u00a0% | height +20.0\u00a0% | 3\u00a0of\u00a04 | 25\u00a0s |"
            in text)
    assert ("| [Study \\| stones](examples/study/README.md) | no result |  |  |  |  |  |" in text
            and text.count("no result") == 1)
    assert ("has the 2 of 3 scenes in which" in text and "Over all scenes 2 of 3 judged figures "
            "with a reference from outside are met" in text)
    with_other["both"]["study"] = [{**MAIN["both"]["study"][0], "of": ".*"}]
    monkeypatch.setattr(results, "main_figures", lambda: with_other)
    # the other has no target
    assert ("| slope 1.9 | 2 (theory) | -5.0\u00a0% | order -1.0\u00a0% | 1\u00a0of\u00a01 | "
            "10\u00a0min |" in results.readme(text, found))


def test_main_figures_are_of_the_bundled_scenes():
    """Every scene has a group; what is declared is in the results as they are committed, with the
    run that gave it, and in the README in words."""
    declared, found = results.main_figures(), results.ran({"scenes": results.scenes_of(paths.PAGE)})
    assert sorted(name for scenes in declared.values() for name in scenes) == paths.examples()
    missing = [(name, row["figure"]) for scenes in declared.values()
               for name, rows in scenes.items() for row in rows
               if not results.main_of(row, found[name])]
    assert not missing
    table = results.headlines({"scenes": found}, "")
    assert (len(table.splitlines()) >= 12 and "no result" not in table and " None " not in table
            and table in (paths.ROOT / "README.md").read_text())
    assert not [line for line in table.splitlines() if "_" in line.split("|")[2]
                + line.split("|")[5]]


def test_results_of_several_commits_or_with_changes_are_refused(tree):
    path = tree / "results/study/summary.json"
    text = path.read_text()
    path.write_text(text.replace("abcdef0123", "0123456789"))
    with pytest.raises(Refusal, match="0123456789, abcdef0123: pages are of one commit"):
        results.collect(tree / "results")
    for file in (path, tree / "results/stone/summary.json"):
        file.write_text(text.replace("abcdef0123", "abcdef0123+") if file == path
                        else file.read_text().replace("abcdef0123", "abcdef0123+"))
    with pytest.raises(Refusal, match="without changes"):
        results.collect(tree / "results")
    with pytest.raises(Refusal, match="no summary.json"):
        results.collect(tree / "nowhere")


def test_page_follows_from_its_json(found):
    assert json.loads(results.packed(found)) == json.loads(json.dumps(found)) and results.packed(
        found).count('"name"') == 8
    assert all(line.count('"name"') < 2 for line in results.packed(found).splitlines())
    assert results.render(json.loads(json.dumps(found))) == results.render(found)


def test_picture_shows_each_figure_over_its_target(found, tmp_path, monkeypatch):
    """Sizes of the dots' places: error over target; a target of 0 that is met at the left, one that
    is missed at the right."""
    drawn = {}

    def savefig(figure, *arguments, **options):
        axes, = figure.axes
        drawn.update({line.get_color(): sorted(map(float, line.get_xdata())) for line in axes.lines
                      if line.get_marker() == "o" and 0 in line.get_ydata()})
        saved(figure, *arguments, **options)
    saved = results.plot.Figure.savefig
    monkeypatch.setattr(results.plot.Figure, "savefig", savefig)
    results.draw(found, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 1000
    assert (drawn[results.plot.GREEN] == pytest.approx([1e-3, 0.2, 0.4]) and drawn[results.plot.RED]
            == pytest.approx([2.0]))
    missed = copy.deepcopy(found)
    missed["scenes"]["stone"]["summary"]["figures"][2] |= {"value": 1, "met": False}
    results.draw(missed, tmp_path / "b.png")
    assert drawn[results.plot.RED] == pytest.approx([2.0, 30.0])
