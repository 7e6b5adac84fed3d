"""Figures of all scenes: what is collected, the page, the README's table and the picture, made of a made-up folder of results."""

import copy
import csv
import io
import json

import pytest

from fsi import paths, results
from fsi.command import Refusal

COST = {"particles": 1234, "steps": 10, "ranks": 2, "cpu_seconds": 12.34, "particle_steps_per_second": 1e6,
        "particle_steps_per_second_per_rank": 5e5, "bytes_per_particle": 800.0, "lammps": "4 Feb 2025", "commit": "abcdef0123", "date": "2026-11-24"}


def figure(name, value, unit="", reference=None, source=None, target=None, met=None, error=None):
    return {"name": name, "value": value, "unit": unit, "reference": reference, "source": source, "target": target,
            "met": met, "relative_error": error}


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """Three scenes: `stone`, one run; `study`, two cases and one that failed; `lost`, without results."""
    monkeypatch.setattr(paths, "EXAMPLES", tmp_path / "examples")
    monkeypatch.setattr(paths, "DRIVERS", tmp_path / "unittest")
    for name, text in (("stone", "# Falling stone\n\nA stone falls.\n"), ("study", "# Study | stones\n\nMany.\n"), ("lost", "# Lost\n\nNo stone.\n")):
        folder = paths.EXAMPLES / name
        folder.mkdir(parents=True)
        (folder / f"in.{name}").write_text("")
        (folder / "README.md").write_text(text)
    stone = {"scene": "stone", "given": {"dx": "2"}, **COST, "figures": [
        figure("speed", 11.0, "m/s", 10.0, "experiment, A | B 1999", 0.05, False, 0.1),
        figure("time", 1.01, "s", 1.0, "theory", 0.05, True, 0.01),
        figure("lost", 0, "", None, None, 0, True), figure("height", 1.2, "m", 1.0, "our own run", 0.5, True, 0.2),
        figure("colour", None, "nm"), figure("cpu_seconds", 12.34, "s")]}
    study = {"scene": "study", **COST, "failed_cases": ["wide"],
             "cases": {"small": {"particles": 10, "cpu_seconds": 1.0, "ranks": 1}, "large": {"particles": 1234, "cpu_seconds": 200.0, "ranks": 3}},
             "figures": [figure("order", 1.98, "", 2.0, "theory: a line", None, None, -0.01), figure("slope", 1.9, "", 2.0, "the same", 0.1, True, -0.05)]}
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
    assert "**4 of 5 targets are met.**" in head
    assert "**Failed, in part or as a whole: lost, study.**" in head
    assert "All 2 scenes together take 0.2 hours on one core." in head  # 2 * 12.34 + 1 + 3 * 200 s
    assert head.count("![") == 1


def test_table(found):
    page = results.render(found)
    assert ("| [Falling stone](../../examples/stone/README.md) | `speed` | 11\u00a0m/s | 10 (experiment, A \\| B 1999) | +10.0\u00a0% | 5 % | **no** | 25 |"
            in page)
    assert "|  | `time` | 1.01\u00a0s | 1 (theory) | +1.0\u00a0% | 5 % | yes |  |" in page
    assert "`lost`" not in page and "- 1 further bounds without a reference are kept." in page
    missed = copy.deepcopy(found)
    missed["scenes"]["stone"]["summary"]["figures"][2] |= {"value": 1, "met": False}
    assert "|  | `lost` | 1 |  |  | 0 | **no** |  |" in results.render(missed)
    assert "| [Study \\| stones](../../examples/study/README.md) | `slope` | 1.9 | 2 (the same) | -5.0\u00a0% | 10 % | yes | 601 |" in page
    # no target: in the table of all figures; what a run costs: in neither
    assert "`colour`" not in page and "`order`" not in page and "`cpu_seconds`" not in page
    rows = list(csv.DictReader(io.StringIO(results.table(found))))
    assert [row["figure"] for row in rows] == ["speed", "time", "lost", "height", "colour", "order", "slope"]
    assert rows[0] == {"scene": "stone", "figure": "speed", "value": "11.0", "unit": "m/s", "reference": "10.0", "source": "experiment, A | B 1999",
                       "error": "0.1", "target": "0.05", "met": "False", "commit": "abcdef0123", "date": "2026-11-24"}


def test_headlines(found, monkeypatch):
    """The README's table: the judged figure that is off by most, not by a run of our own; what is no longer there; else the README stays as it is."""
    monkeypatch.setattr(results, "HEADLINES", (("How fast", "study", r"slope|order", "large"), ("Gone", "study", "gone", "large"),
                                               ("No case", "study", "slope", "wide"), ("Not run", "lost", "x", None)))
    monkeypatch.setattr(results, "WORDS", ((r"slo", "slope of it"),))
    rows = ["| [How fast](examples/study/README.md) | slope of it | 1.9 | 2 (theory) | -5.0\u00a0% | 1\u00a0of\u00a01 | 10\u00a0min |",
            "| [Gone](examples/study/README.md) | no result |  |  |  |  |  |"]
    text = results.readme(f"# Title\n{results.MARKS[0]}old\n{results.MARKS[1]}## Rest\n", found)
    assert text.startswith("# Title\n") and text.endswith("## Rest\n") and "old" not in text
    assert text.splitlines()[5:7] == rows and text.count("no result") == 3
    found["scenes"]["stone"]["summary"]["cases"] = {"one": {"cpu_seconds": 3.0, "ranks": 1}}
    monkeypatch.setattr(results, "HEADLINES", (("Worst", "stone", ".*", "one"),))
    assert "| speed | 11\u00a0m/s | 10 (experiment) | +10.0\u00a0% | 3\u00a0of\u00a04 | 3\u00a0s |" in results.readme(text, found)  # not the height, off by 20 % of our own run


def test_headlines_are_of_the_bundled_scenes():
    """Interaction first; each has a truth in the results as they are committed, and so in the README; each name of a figure is in words."""
    found = results.scenes_of(paths.PAGE)
    table = results.headlines(found, "")
    assert len(table.splitlines()) == 2 + len(results.HEADLINES) == 10 and "no result" not in table and " None " not in table
    assert all("FSI" in line for line in table.splitlines()[2:5])
    assert not [line for line in table.splitlines() if "_" in line.split("|")[2]]
    assert table in (paths.ROOT / "README.md").read_text()


def test_results_of_several_commits_or_with_changes_are_refused(tree):
    path = tree / "results/study/summary.json"
    text = path.read_text()
    path.write_text(text.replace("abcdef0123", "0123456789"))
    with pytest.raises(Refusal, match="0123456789, abcdef0123: pages are of one commit"):
        results.collect(tree / "results")
    for file in (path, tree / "results/stone/summary.json"):
        file.write_text(text.replace("abcdef0123", "abcdef0123+") if file == path else file.read_text().replace("abcdef0123", "abcdef0123+"))
    with pytest.raises(Refusal, match="without changes"):
        results.collect(tree / "results")
    with pytest.raises(Refusal, match="no summary.json"):
        results.collect(tree / "nowhere")


def test_page_follows_from_its_json(found):
    assert json.loads(results.packed(found)) == json.loads(json.dumps(found)) and results.packed(found).count('"name"') == 8
    assert all(line.count('"name"') < 2 for line in results.packed(found).splitlines())
    assert results.render(json.loads(json.dumps(found))) == results.render(found)


def test_picture_shows_each_figure_over_its_target(found, tmp_path, monkeypatch):
    """Sizes of the dots' places: error over target; a target of 0 that is met at the left, one that is missed at the right."""
    drawn = {}

    def savefig(figure, *arguments, **options):
        axes, = figure.axes
        drawn.update({line.get_color(): sorted(map(float, line.get_xdata())) for line in axes.lines if line.get_marker() == "o" and 0 in line.get_ydata()})
        saved(figure, *arguments, **options)
    saved = results.plot.Figure.savefig
    monkeypatch.setattr(results.plot.Figure, "savefig", savefig)
    results.draw(found, tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 1000
    assert drawn[results.plot.GREEN] == pytest.approx([1e-3, 0.2, 0.4]) and drawn[results.plot.RED] == pytest.approx([2.0])
    missed = copy.deepcopy(found)
    missed["scenes"]["stone"]["summary"]["figures"][2] |= {"value": 1, "met": False}
    results.draw(missed, tmp_path / "b.png")
    assert drawn[results.plot.RED] == pytest.approx([2.0, 30.0])
