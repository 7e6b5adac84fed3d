"""The figures of all scenes, from the summaries that tools/run leaves, and the page of those that have a target. tools/renew writes it."""

import csv
import io
import json
import re
from pathlib import Path

import numpy as np

from . import paths, plot
from .command import Refusal
from .summary import bound, deviation, number

COST = ("cpu_seconds", "particle_steps_per_second", "bytes_per_particle")  # every summary has them; no figures of a scene
COLUMNS = ("scene", "figure", "value", "unit", "reference", "source", "error", "target", "met")
WHOLE = "\u00a0"  # a blank that a narrow column does not break
MARKS = ("<!-- results: written by tools/renew -->\n", "<!-- end of results -->\n")  # where the README has its table
# The README's table: what, scene, its figures as a regular expression, the case whose time stands beside. The worst judged figure is shown
HEADLINES = (
    ("Elastic flag behind a cylinder, steady (FSI1)", "turek_hron_fsi", r".*_fsi1_4", "fsi1_4"),
    ("The same, swinging widely (FSI2)", "turek_hron_fsi", r".*_fsi2_2_to_8", "fsi2_2_to_8"),
    ("The same, swinging fast (FSI3)", "turek_hron_fsi", r".*_fsi3_2_to_8", "fsi3_2_to_8"),
    ("Elastic gate that lets water out", "elastic_gate", r"12MPa_.*", "12MPa_5_across"),
    ("Plate under 2 m of water", "hydrostatic_plate", r".*", "11_across"),
    ("Dam break on an elastic plate, 3D", "dam_break_elastic", r".*", "plate"),
    ("Elastic plate alone", "oscillating_plate", r".*", "tl_10"),
    ("Rigid cylinder in a channel, Re = 20 and 100", "cylinder_channel", r".*", "re_100_14_to_40"))
WORDS = (  # of names of figures, for readers who do not know them; the first that fits
    (r"(ux|uy)_fsi1", "displacement of the tip"), (r"uy_amplitude", "amplitude of the tip"), (r"drag_amplitude", "amplitude of the drag"),
    (r"lift_amplitude", "amplitude of the lift"), (r"drag", "drag"), (r"lift", "lift"), (r"strouhal", "Strouhal number"), (r"frequency", "frequency"),
    (r"tip_x_peak_time", "time of the peak"), (r"tip_y_peak", "rise of the tip at the peak"), (r"tip_x_peak", "deflection at the peak"),
    (r"tip_x_rest", "deflection at rest"), (r"deflection", "deflection at the middle"), (r"a100_a1.*_ul", "amplitude after 100 swings, updated Lagrangian"),
    (r"a100_a1", "amplitude after 100 swings"), (r"period.*_ul", "period, updated Lagrangian"), (r"period", "period"))


def collect(results):
    """What tools/run left in `results`, {"command", "scenes": {name: {"summary" or None}}}: all of one commit without changes."""
    found = {}
    for name in paths.scenes():
        path = Path(results) / name / "summary.json"
        found[name] = {"summary": json.loads(path.read_text()) if path.exists() else None}
    commits = {entry["summary"].get("commit") or "unknown" for entry in found.values() if entry["summary"]}
    if not commits:
        raise Refusal(f"{results} holds no summary.json of a scene: tools/run all makes them")
    if len(commits) > 1 or any(not re.fullmatch("[0-9a-f]+", commit) for commit in commits):
        raise Refusal(f"{results} holds results of {', '.join(sorted(commits))}: pages are of one commit without changes (+); tools/run all renews the others")
    return {"command": "tools/run all", "scenes": found}


def title(name):
    """The heading of a scene's README."""
    path = paths.folder(name) / "README.md"
    return next((line.lstrip("# ") for line in path.read_text().splitlines() if line.startswith("# ")), name) if path.exists() else name


def _page(name, up):
    """The link to a scene's page."""
    return f"{up}{paths.folder(name).parent.name}/{name}/README.md"


def scenes_of(page):
    """What the results.json of a folder has, by scene."""
    path = Path(page) / "results.json"
    return json.loads(path.read_text())["scenes"] if path.exists() else {}


def packed(found):
    """results.json as text, a line for each figure."""
    return re.sub(r"\{[^{}\[\]]*\}", lambda m: re.sub(r"\s*\n\s*", " ", m[0]), json.dumps(found, indent=1)) + "\n"


def judged(entry):
    """The figures of a scene that have a target."""
    return [f for f in entry["summary"]["figures"] if f["target"] is not None]


def listed(entry):
    """Those that the page lists: what is compared with a reference, and what is missed; of a scene without either the first."""
    figures = judged(entry)
    return [f for f in figures if f["reference"] is not None or not f["met"]] or figures[:1]


def table(found):
    """results.csv: one line a figure."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow((*COLUMNS, "commit", "date"))
    for name, entry in found["scenes"].items():
        if summary := entry["summary"]:
            rows.writerows((name, f["name"], f["value"], f["unit"], f["reference"], f["source"], f["relative_error"], f["target"], f["met"],
                            summary["commit"], summary.get("date")) for f in summary["figures"] if f["name"] not in COST)
    return text.getvalue()


def render(found, up="../../"):
    """The page as Markdown; `up` leads from it to the root."""
    scenes = {name: entry for name, entry in found["scenes"].items() if entry["summary"]}
    every = [f for entry in scenes.values() for f in judged(entry)]
    hours = sum(core_seconds(entry["summary"]) for entry in scenes.values()) / 3600
    lines = ["# Results", "",
             "What the scenes compute, next to experiments, theory and finite elements.",
             f"**{sum(f['met'] for f in every)} of {len(every)} targets are met.**",
             f"All {len(scenes)} scenes together take {hours:.1f} hours on one core.", "",
             "![Size of each figure's error over its target](results.png)", "",
             "Each dot is a figure that has a target. Right of the line the target is missed.", "",
             "- The error is relative to the reference. Where there is none, the target bounds the value itself.",
             "- References are experiments and theory unless they say otherwise. *Code* is another program. Without a source it is the one above.",
             "- CPU seconds are those of all runs of a scene on one core.",
             f"- {len(every) - sum(len(listed(entry)) for entry in scenes.values())} further bounds without a reference are kept. They are in "
             "[results.csv](results.csv), with all figures that have no target.", ""]
    missing = [name for name, entry in found["scenes"].items() if not entry["summary"] or entry["summary"].get("failed_cases")]
    if missing:
        lines += [f"**Failed, in part or as a whole: {', '.join(missing)}.**", ""]
    return "\n".join(lines) + "\n" + _table(scenes, up) + "\n"


def _table(scenes, up):
    rows = []
    for name, entry in scenes.items():
        above = None  # the source of the last reference
        for k, f in enumerate(listed(entry)):
            reference = "" if f["reference"] is None else number(f["reference"])
            if f["source"] and (f["source"] != above or not reference):
                reference = f"{reference} ({f['source']})" if reference else f["source"]
            above = f["source"] or above
            rows.append([f"[{title(name)}]({_page(name, up)})" if k == 0 else "", f"`{f['name']}`", _value(f), reference, _whole(deviation(f)), bound(f),
                         "yes" if f["met"] else "**no**", f"{core_seconds(entry['summary']):,.0f}" if k == 0 else ""])
    return _markdown(["scene", "quantity", "computed", "reference", "error", "target", "met", "CPU s"], rows)


def core_seconds(ran):
    """CPU seconds of a run, or of all cases of a summary, on one core."""
    cases = ran.get("cases", {}).values() or [ran]
    return sum((case["cpu_seconds"] or 0) * (case["ranks"] or 1) for case in cases)


def headlines(scenes, up):
    """The README's table: of each line the judged figure that is off by most, of those with a reference from outside."""
    rows = []
    for what, name, figures, case in HEADLINES:
        entry = scenes.get(name)
        known = [f for f in judged(entry) if re.fullmatch(figures, f["name"])] if entry and entry["summary"] else []
        outside = [f for f in known if f["relative_error"] is not None and not f["source"].startswith("our ")]
        what = f"[{what}]({_page(name, up)})"
        if not outside or case not in entry["summary"].get("cases", {}):
            rows.append([what, "no result", *[""] * 5])
            continue
        worst = max(outside, key=lambda f: abs(f["relative_error"]))
        rows.append([what, words(worst["name"]), _value(worst), f"{number(worst['reference'])} ({_whose(worst, entry['summary']['figures'])})", _whole(deviation(worst)),
                     _whole(f"{sum(f['met'] for f in known)} of {len(known)}"), _whole(duration(core_seconds(entry["summary"]["cases"][case])))])
    return _markdown(["scene", "its worst figure", "computed", "reference", "error", "targets met", "time on one core"], rows)


def _whole(text):
    """Text that a narrow column does not break."""
    return text.replace(" ", WHOLE)


def _whose(figure, figures):
    """The source of a figure in short: up to a comma or colon, that of an earlier one where it is the same."""
    sources = [f["source"] for f in figures[:figures.index(figure) + 1] if f["source"] and not f["source"].startswith("the same")]
    return re.split("[,:]", (sources or ["?"])[-1])[0]


def words(figure):
    """What a figure's name says."""
    return next((text for pattern, text in WORDS if re.search(pattern, figure)), figure.replace("_", " "))


def _markdown(head, rows):
    """A table; columns of numbers at the right."""
    left = ("scene", "quantity", "reference", "met", "its worst figure")
    lines = [head, ["---" if name in left else "---:" for name in head], *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines)


def _value(figure):
    unit = figure["unit"]
    return f"{number(figure['value'])}{' ' if ' ' in unit else WHOLE}{unit}" if unit else number(figure["value"])


def duration(seconds):
    """Seconds, or minutes where they are many."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def run_times(text, name, summary):
    """A scene's README with the times of its commands made anew: of a case, of all, on one core unless the line says otherwise."""
    def timed(line):
        case, cores = line["case"], line["cores"] or ""
        ran = summary.get("cases", {}).get(case) if case else summary
        if ran is None:  # a case that has not been run for the page
            return line[0]
        seconds = core_seconds(ran)
        if match := re.search(r"on (\d+) cores", cores):
            seconds /= int(match[1])
        return f"{line['head']}{duration(max(1.0, seconds))}{cores}"

    return re.sub(rf"^(?P<head>tools/run {name}(?: case=(?P<case>\S+))?\s+#.*?)\b[\d.]+ (?:s|min)(?P<cores> on .*)?$", timed, text, flags=re.M)


def draw(found, path):
    """Size of the error over the target, a line for each scene."""
    scenes = {name: entry for name, entry in found["scenes"].items() if entry["summary"] and judged(entry)}
    least = 1e-3  # what is less stands at the left
    with plot.picture(path, 7.2, 0.21 * len(scenes) + 0.7) as figure:
        axes = figure.add_subplot()
        axes.axvspan(1.0, 1e3, color=plot.RED, alpha=0.08, linewidth=0)
        for k, entry in enumerate(scenes.values()):
            size = [abs((f["relative_error"] if f["reference"] else f["value"]) or 0.0) / f["target"] if f["target"] else 0.0 if f["met"] else np.inf
                    for f in judged(entry)]
            for missed, colour in ((False, plot.GREEN), (True, plot.RED)):
                x = [min(max(s, least), 30.0) for s in size if (s > 1.0) == missed]
                axes.plot(x, [k] * len(x), "o", markersize=5, color=colour, markeredgecolor="white", markeredgewidth=0.5)
        axes.axvline(1.0, color=plot.GREY, linewidth=1.0)
        axes.set_yticks(range(len(scenes)), [title(name) for name in scenes], fontsize=7.5)
        axes.set(xscale="log", xlim=(0.7 * least, 40.0), ylim=(len(scenes) - 0.4, -0.6), xlabel="size of the error over its target")
        axes.set_xticks([1e-3, 1e-2, 0.1, 1.0, 10.0], ["0.001 or less", "0.01", "0.1", "1", "10"])
        axes.minorticks_off()
        figure.tight_layout()


def readme(text, found, up=""):
    """The repository's README with its table made anew."""
    before, rest = text.split(MARKS[0])
    return before + MARKS[0] + "\n" + headlines(found["scenes"], up) + "\n\n" + MARKS[1] + rest.split(MARKS[1])[1]
