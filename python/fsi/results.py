"""One page about what all scenes gave, from their summaries, pictures and READMEs alone.

    python -m fsi.results [RESULTS [PAGE]]     default: results doc/results; tools/run all ends with it

Writes README.md, results.json (all that the page is made of) and copies of the pictures into the folder PAGE. What was not run keeps what the page
has of it; the page names the commit of each. Its first table is also put between the marks in the README.md of the repository, where PAGE is in one.
"""

import json
import os
import re
import shutil
import sys
from pathlib import Path

from . import paths
from .summary import bound, deviation, number

REMARKS = "Deviations"  # section of a scene's README that the page quotes
COST = ("cpu_seconds", "particle_steps_per_second", "bytes_per_particle")  # every summary has them; columns of their own
SHOWN = 2  # pictures per scene
MARKS = ("<!-- results: written by tools/run all -->\n", "<!-- end of results -->\n")  # where the README has them
# The first table: what, scene, figure, case that it is of (None: all)
HEADLINES = (
    ("Plate under 2 m of water: deflection", "hydrostatic_plate", "deflection_11", "11_across"),
    ("Elastic gate: furthest displacement of its tip", "elastic_gate", "10MPa_tip_x_peak", "10MPa_5_across"),
    ("The same gate under a load known exactly: displacement", "gate_static", "tip_x_5_across", "5_across"),
    ("Oscillating plate: period", "oscillating_plate", "period_10", "tl_10"),
    ("Turek and Hron's beam under gravity (CSM3): frequency", "turek_hron_csm", "frequency_10", "csm3_10"),
    ("Bending column in 3D: first peak", "bending_column", "peak_10", "10_across"),
    ("Taylor bar: final length", "taylor_bar", "final_length_8_across", "8_across"),
    ("Dam break: pressure on the wall after the impact", "dam_break", "pressure_plateau_80", "best"),
    ("Dam break on a box in 3D: arrival of the water", "dam_break_3d", "P1_arrival", None),
    ("Cylinder in a channel, Re = 20: drag coefficient", "cylinder_channel", "drag_20_across", "20_across"),
    ("Rolling tank: period of the oil", "rolling_tank", "sloshing_period_free", "free"),
    ("Standing wave: period", "standing_wave", "period", "viscous"),
    ("Taylor-Green vortices: rate of decay", "taylor_green", "energy_decay_rate", "best"),
    ("Elliptical drop: long axis", "elliptical_drop", "semi_axis_b", "best"),
    ("Rotating square patch: pressure at its centre", "rotating_square_patch", "centre_pressure", "best"),
    ("Floating block: draft", "floating_blocks", "draft_0.5", "0.5"),
)
_IMAGE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
_RELATIVE_LINK = re.compile(r"(\]\()(?![a-z]+:|[#/])([^)\s]+\))")


def collect(results):
    """What is to be said, as a dictionary that JSON can hold; scenes in the order of their names."""
    found = {}
    for name in paths.scenes():
        path = Path(results) / name / "summary.json"
        summary = json.loads(path.read_text()) if path.exists() else None
        found[name] = {**_readme(name), "summary": summary,
                       "pictures": _pictures(name, path.parent, summary) if summary else []}
    return {"scenes": found}


def _readme(name):
    """Title, first line and remarks of a scene's README."""
    path = paths.EXAMPLES / name / "README.md"
    text = path.read_text() if path.exists() else ""
    lines = text.splitlines()
    title = next((line.lstrip("# ") for line in lines if line.startswith("# ")), name)
    description = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    section = re.search(rf"^## {REMARKS}[ \t]*\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    return {"title": title, "description": description, "remarks": section[1].strip() if section else ""}


def _pictures(name, folder, summary):
    """[{file, alt}], `file` below `folder`: those that the README shows, else all; of a study's cases the largest's."""
    cases = sorted(summary.get("cases", {}), key=lambda case: -(summary["cases"][case]["particles"] or 0))
    places = [folder, *(folder / case for case in cases)]
    readme = paths.EXAMPLES / name / "README.md"
    shown = _IMAGE.findall(readme.read_text()) if readme.exists() else []
    if not shown:
        shown = [("", path.name) for place in places for path in sorted(place.glob("*.png"))]
    found = {}
    for alt, target in shown:
        path = next((place / target for place in places if (place / target).is_file()), None)
        if path:
            found.setdefault(str(path.relative_to(folder)), alt)
    return [{"file": file, "alt": alt or f"{name}: {Path(file).stem}"} for file, alt in found.items()][:SHOWN]


def copied(name, picture):
    """Name of a picture's copy on the page: scene, case and file in one."""
    return "_".join([name, *Path(picture["file"]).parts])


def render(found, examples="../../examples"):
    """The page as Markdown; `examples` leads from it to the scenes."""
    scenes = {name: entry for name, entry in found["scenes"].items() if entry["summary"]}
    parts = [_head(found["scenes"], scenes)]
    if short := headlines(scenes, examples):
        parts += ["## In short", short]
    parts += ["## Gallery", _gallery(scenes, examples), "## Figures", _explanation(scenes), _table(scenes, judged=True)]
    rest = _table(scenes, judged=False)
    if rest:
        parts += ["### Further figures, which there is nothing to judge by", rest]
    remarks = [f"### {entry['title']}\n\n" + _RELATIVE_LINK.sub(rf"\g<1>{examples}/{name}/\2", entry["remarks"])
               for name, entry in scenes.items() if entry["remarks"]]
    if remarks:
        parts += [f"## {REMARKS}", *remarks]
    return "\n\n".join(parts) + "\n"


def _head(every, scenes):
    """What somebody in a hurry has to know: targets met and missed, what did not run, what it was run with."""
    versions = {entry["summary"].get("lammps") or "unknown" for entry in scenes.values()}
    commits = {}
    for name, entry in scenes.items():
        commits.setdefault(entry["summary"].get("commit") or "unknown", []).append(name)
    used = " and ".join(c if len(commits) == 1 else f"{c} ({', '.join(n)})" for c, n in commits.items())
    changed = " (+: with changes that are not committed)" if any(c.endswith("+") for c in commits) else ""
    seconds = sum(entry["summary"]["cpu_seconds"] or 0 for entry in scenes.values())
    lines = ["# Results", "", "Made by `tools/run all`: every number and picture comes from its runs, none is typed. "
             f"LAMMPS {', '.join(sorted(versions))}; commit {used}{changed}; {_duration(seconds)} in all."]
    judged = [(name, f) for name, entry in scenes.items() for f in entry["summary"]["figures"] if f["met"] is not None]
    missed = [(name, f) for name, f in judged if not f["met"]]
    if judged:
        lines += ["", f"**{len(judged) - len(missed)} of {len(judged)} targets met.**" + (" Missed:" if missed else "")]
        lines += [f"- {name}, `{f['name']}`: {_ours(f)}" +
                  (f" against {number(f['reference'])}, {deviation(f)}" if f["reference"] is not None else "") +
                  f" (allowed: {bound(f)})" for name, f in missed]
    for name, entry in every.items():
        if not entry["summary"]:
            lines += ["", f"**{name} has no results**: it was not run, or failed."]
        elif entry["summary"].get("failed_cases"):
            lines += ["", f"**{name}: failed** in {', '.join(entry['summary']['failed_cases'])}."]
    return "\n".join(lines)


def headlines(scenes, examples):
    """The first table: some figures that have a truth to be judged by, with what they cost. Empty without results of any."""
    rows = []
    for what, name, figure, case in HEADLINES:
        summary = scenes[name]["summary"] if name in scenes else None
        if summary is None:
            continue
        what = f"[{what}]({examples}/{name}/README.md)"
        found = next((f for f in summary["figures"] if f["name"] == figure), None)
        ran = summary.get("cases", {}).get(case) if case else summary
        rows.append([what, _ours(found), f"{number(found['reference'])} ({found['source']})", deviation(found), f"{ran['particles']:,}",
                     f"{_duration(ran['cpu_seconds'])} on {ran['ranks']}"] if found and ran else [what, "no result", "", "", "", ""])
    return _markdown(["figure", "ours", "truth", "error", "particles", "CPU time on cores"], rows) if rows else ""


def _gallery(scenes, examples):
    """Two scenes side by side, each with its title, what it is, and at most two pictures."""
    cells = ["<br>".join([f"**[{entry['title']}]({examples}/{name}/README.md)**", entry["description"],
                          *(f"![{p['alt']}]({copied(name, p)})" for p in entry["pictures"])]).replace("|", "\\|") for name, entry in scenes.items()]
    rows = [f"| {left} | {right} |" for left, right in zip(cells[::2], [*cells[1::2], ""])]
    return "\n".join(["|  |  |", "|---|---|", *rows])


def _explanation(scenes):
    text = ("`error` is relative to the reference. The target bounds its size, or, where the reference is none or 0, that of "
            "the value. What is no experiment, theory or finite elements says so in `source`. Particles: of the largest "
            "case; CPU seconds: of all cases, on each of the ranks.")
    own = [f"{name} with {' '.join(f'{k}={v}' for k, v in entry['summary']['given'].items())}"
           for name, entry in scenes.items() if entry["summary"].get("given")]
    return text + (f" **Not as bundled: {'; '.join(own)}.**" if own else "")


def _table(scenes, judged):
    """The figures that have a reference or a target, or the others; empty if there are none."""
    head = ["scene", "figure", "ours", "reference", "source", "error", "target", "particles", "CPU seconds", "ranks"]
    rows = []
    for name, entry in scenes.items():
        summary = entry["summary"]
        cost = [number(summary["particles"]), f"{summary['cpu_seconds'] or 0:.1f}", number(summary["ranks"])]
        if len(summary.get("cases", ())) > 1:
            cost[0] = f"{len(summary['cases'])} cases, {cost[0]}"
        figures = [f for f in summary["figures"] if f["name"] not in COST and judged ==
                   (f["reference"] is not None or f["target"] is not None)]
        for k, f in enumerate(figures):
            met = {None: "", True: "✓ ", False: "**✗ missed** "}[f["met"]]
            reference = "" if f["reference"] is None else number(f["reference"])
            rows.append([name, f"`{f['name']}`", _ours(f), reference, f["source"] or "", deviation(f),
                         met + bound(f), *(cost if k == 0 else [""] * 3)])
    if not judged:
        head, rows = head[:3], [row[:3] for row in rows]
    if not rows:
        return ""
    return _markdown(head, rows)


def _markdown(head, rows):
    """A table; columns of numbers at the right."""
    numbers = ("ours", "reference", "error", "particles", "CPU seconds", "ranks", "CPU time on cores")
    lines = [head, ["---:" if title in numbers else "---" for title in head], *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _ours(figure):
    return f"{number(figure['value'])} {figure['unit']}".strip()


def _duration(seconds):
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} minutes"


def write(results, page):
    """Makes the page of what is in `results`; returns the dictionary it is made of."""
    results, page = Path(results), Path(page)
    found = collect(results)
    if not any(entry["summary"] for entry in found["scenes"].values()):
        raise FileNotFoundError(f"{results} holds no summary.json of a scene")
    page.mkdir(parents=True, exist_ok=True)
    before = scenes_of(page)
    for name, entry in found["scenes"].items():
        if entry["summary"]:
            for picture in before.get(name, {}).get("pictures", []):
                (page / copied(name, picture)).unlink(missing_ok=True)
            for picture in entry["pictures"]:
                shutil.copyfile(results / name / picture["file"], page / copied(name, picture))
        elif name in before:
            entry.update(summary=before[name]["summary"], pictures=before[name]["pictures"])
    (page / "results.json").write_text(json.dumps(found, indent=2) + "\n")
    (page / "README.md").write_text(render(found, Path(os.path.relpath(paths.EXAMPLES, page)).as_posix()))
    if page.resolve() == (paths.ROOT / "doc/results").resolve():
        write_readme(found)
    print(f"results: {page / 'README.md'}")
    return found


def write_readme(found):
    """Puts the first table into the README of the repository."""
    path = paths.ROOT / "README.md"
    before, rest = path.read_text().split(MARKS[0])
    table = headlines({name: entry for name, entry in found["scenes"].items() if entry["summary"]}, "examples")
    path.write_text(before + MARKS[0] + "\n" + table + "\n\n" + MARKS[1] + rest.split(MARKS[1])[1])


def scenes_of(page):
    """What the results.json of a page has, by scene."""
    path = page / "results.json"
    return json.loads(path.read_text())["scenes"] if path.exists() else {}


if __name__ == "__main__":
    if len(sys.argv) > 3 or any(word.startswith("-") for word in sys.argv[1:]):
        sys.exit(__doc__)
    try:
        write(*sys.argv[1:], *(paths.RESULTS, paths.PAGE)[len(sys.argv) - 1:])
    except FileNotFoundError as error:
        sys.exit(f"results: {error}")
