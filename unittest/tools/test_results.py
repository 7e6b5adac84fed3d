"""The page of results, made of a made-up folder of them."""

import json

import pytest

from fsi import paths, results

README = """# Falling stone

A stone falls.

## What to expect
![the fall](fall.png)
![as everybody knows it](../../doc/unrelated.png)

## Deviations
Too *fast*, see ![curve](curve.png) and [theory](../../doc/testing.md), [web](https://example.org), [below](#x).

### In detail
Air.

## Literature
Not to be quoted.
"""
COST = {"particles": 1234, "steps": 10, "ranks": 2, "cpu_seconds": 12.34, "particle_steps_per_second": 1e6,
        "particle_steps_per_second_per_rank": 5e5, "bytes_per_particle": 800.0, "lammps": "4 Feb 2025", "commit": "abc"}


def figure(name, value, unit="", reference=None, source=None, target=None, met=None, error=None):
    return {"name": name, "value": value, "unit": unit, "reference": reference, "source": source, "target": target,
            "met": met, "relative_error": error}


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """Three scenes: `stone`, one run; `study`, two cases of which one failed; `lost`, without results."""
    monkeypatch.setattr(paths, "EXAMPLES", tmp_path / "examples")
    for name, text in (("stone", README), ("study", "# Study\n\nMany stones.\n"), ("lost", "# Lost\n\nNo stone.\n")):
        folder = paths.EXAMPLES / name
        folder.mkdir(parents=True)
        (folder / f"in.{name}").write_text("")
        (folder / "README.md").write_text(text)
    stone = {"scene": "stone", "given": {"dx": "2"}, **COST, "figures": [
        figure("speed", 11.0, "m/s", 10.0, "experiment, A | B 1999", 0.05, False, 0.1),
        figure("time", 1.01, "s", 1.0, "theory", 0.05, True, 0.01),
        figure("lost", 0, "", None, None, 0, True),
        figure("colour", None, "nm"), figure("cpu_seconds", 12.34, "s")]}
    study = {"scene": "study", **COST, "commit": "def+", "failed_cases": ["wide"],
             "cases": {"small": {"particles": 10}, "large": {"particles": 1234}},
             "figures": [figure("order", 1.98, "", 2.0, "theory", None, None, -0.01)]}
    for name, summary in (("stone", stone), ("study", study)):
        write(tmp_path / "results" / name / "summary.json", json.dumps(summary))
    for file in ("stone/fall.png", "stone/other.png", "study/order.png", "study/small/fall.png", "study/large/fall.png"):
        write(tmp_path / "results" / file, file)
    return tmp_path


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def page_of(tree):
    results.write(tree / "results", tree / "doc" / "results")
    return (tree / "doc" / "results" / "README.md").read_text()


def test_head_says_what_is_met_what_is_not_and_what_is_missing(tree):
    head = page_of(tree).split("## Gallery")[0]
    assert "**2 of 3 targets met.** Missed:" in head
    assert "- stone, `speed`: 11 m/s against 10, +10.0 % (allowed: 5 %)" in head
    assert "**lost has no results**" in head
    assert "**study: failed** in wide." in head
    assert "LAMMPS 4 Feb 2025; commit abc (stone) and def+ (study) (+: with changes" in head


def test_table(tree):
    page = page_of(tree)
    assert ("| stone | `speed` | 11 m/s | 10 | experiment, A \\| B 1999 | +10.0 % | **✗ missed** 5 % | 1234 | 12.3 | 2 |"
            in page)
    assert "| stone | `time` | 1.01 s | 1 | theory | +1.0 % | ✓ 5 % |  |  |  |" in page
    assert "| stone | `lost` | 0 |  |  |  | ✓ 0 |  |  |  |" in page
    assert "| study | `order` | 1.98 | 2 | theory | -1.0 % |  | 2 cases, 1234 | 12.3 | 2 |" in page
    assert "**Not as bundled: stone with dx=2.**" in page
    # nothing to judge it by: below the table; what a run costs: not as a figure
    judged, rest = page.split("### Further figures")
    assert "`colour`" not in judged and "| stone | `colour` | - nm |" in rest
    assert "`cpu_seconds`" not in page


def test_gallery_shows_what_the_readme_shows_else_everything(tree):
    page = page_of(tree)
    folder = tree / "doc" / "results"
    assert "**[Falling stone](../../examples/stone/README.md)**<br>A stone falls.<br>![the fall](stone_fall.png) |" in page
    assert (folder / "stone_fall.png").read_text() == "stone/fall.png"
    assert "stone_other.png" not in page
    # a case's picture where the study has none of that name: the largest case's
    assert {p.name for p in folder.glob("*.png")} == {"stone_fall.png", "study_order.png", "study_large_fall.png"}
    assert page.index("study_order.png") < page.index("study_large_fall.png")
    write(paths.EXAMPLES / "study" / "README.md", "# Study\n\nMany.\n\n![fall](fall.png)\n")
    page_of(tree)
    assert {p.name for p in folder.glob("*.png")} == {"stone_fall.png", "study_large_fall.png"}


def test_headlines(tree, monkeypatch):
    """The first table: of a run, of one case with its own cost, of what is no longer there; in the README, which else stays as it is."""
    monkeypatch.setattr(results, "HEADLINES", (("How fast", "stone", "speed", None), ("Order | slope", "study", "order", "large"),
                                               ("Gone", "stone", "gone", None), ("Not run", "lost", "x", None)))
    monkeypatch.setattr(paths, "ROOT", tree)
    write(tree / "README.md", f"# Title\n{results.MARKS[0]}old\n{results.MARKS[1]}## Rest\n")
    summary = json.loads((tree / "results/study/summary.json").read_text())
    summary["cases"]["large"] |= {"cpu_seconds": 200.0, "ranks": 3}
    write(tree / "results/study/summary.json", json.dumps(summary))
    rows = ["| [How fast](examples/stone/README.md) | 11 m/s | 10 (experiment, A \\| B 1999) | +10.0 % | 1,234 | 12 s on 2 |",
            "| [Order \\| slope](examples/study/README.md) | 1.98 | 2 (theory) | -1.0 % | 1,234 | 3 minutes on 3 |",
            "| [Gone](examples/stone/README.md) | no result |  |  |  |  |"]
    assert all(row.replace("(examples", "(../../examples") in page_of(tree) for row in rows)
    text = (tree / "README.md").read_text()
    assert text.startswith("# Title\n") and text.endswith("## Rest\n") and "old" not in text
    assert text.splitlines()[5:8] == rows


def test_headlines_are_of_the_bundled_scenes():
    """Each stands in the results as they are committed, with a truth, and so in the README."""
    found = json.loads((paths.PAGE / "results.json").read_text())["scenes"]
    table = results.headlines(found, "examples")
    assert len(table.splitlines()) == 2 + len(results.HEADLINES) and "no result" not in table and " None " not in table
    assert table in (paths.ROOT / "README.md").read_text()


def test_remarks_are_quoted_with_links_that_work(tree):
    remarks = page_of(tree).split("## Deviations")[1]
    assert ("Too *fast*, see ![curve](../../examples/stone/curve.png) and [theory](../../examples/stone/../../doc/testing.md), "
            "[web](https://example.org), [below](#x).\n\n### In detail\nAir.") in remarks
    assert "quoted" not in remarks and "Study" not in remarks


def test_page_follows_from_its_json(tree):
    page = page_of(tree)
    assert results.render(json.loads((tree / "doc" / "results" / "results.json").read_text())) == page


def test_nothing_to_show_is_refused(tree):
    with pytest.raises(FileNotFoundError, match="no summary.json"):
        results.write(tree / "nowhere", tree / "doc" / "results")
    assert not (tree / "doc").exists()


def test_what_was_not_run_again_stays(tree):
    before = page_of(tree)
    (tree / "results" / "stone").rename(tree / "elsewhere")
    summary = tree / "results" / "study" / "summary.json"
    summary.write_text(summary.read_text().replace("1.98", "1.97"))
    after = page_of(tree)
    assert after == before.replace("1.98", "1.97")
    page = tree / "doc" / "results"
    assert (page / "stone_fall.png").read_text() == "stone/fall.png"
    (tree / "elsewhere").rename(tree / "results" / "stone")
    (tree / "results" / "stone" / "fall.png").unlink()
    page_of(tree)
    assert not (page / "stone_fall.png").exists()
