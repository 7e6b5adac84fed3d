"""The figures of all scenes, from the summaries that tools/run leaves, and the page of those that
have a target. tools/renew writes it."""

import csv
import io
import json
import re
from pathlib import Path

import numpy as np

from . import paths, plot
from .command import Refusal
from .summary import bound, deviation, number

# every summary has them; no figures of a scene
COST = ("cpu_seconds", "particle_steps_per_second", "bytes_per_particle")
COLUMNS = ("scene", "figure", "value", "unit", "reference", "kind", "source", "error_percent",
           "target", "met")
WHOLE = "\u00a0"  # a blank that a narrow column does not break
# where the README has its table
MARKS = ("<!-- results: written by tools/renew -->\n", "<!-- end of results -->\n")
OWN = "own run"
KINDS = (  # of references, by how a source begins; the first that fits
    (OWN, r"our |the recommended scheme|2 ranks against|finest water|4 particles|with the gate"),
    ("experiment", r"experiment|Clift"),
    ("finite elements", r"(?:code[,:] )?(?:converged |2D )?finite elements|Turek & Hron"),
    ("code", r"codes?\b|Schaefer|Johnson"),
    ("theory", r"(?:beam |linear )?theory|exact|Archimedes|no damping|Timoshenko|elastic "
     r"ring|Fourier|finite differences"),
    (None, r"mean over|root mean"))  # no reference, a remark
WORDS = (  # of names of figures, for readers who do not know them; the first that fits
    (r"drag_amplitude", "amplitude of the drag"), (r"lift_amplitude", "amplitude of the lift"),
         (r"drag", "drag"), (r"tip_x_peak_time", "time of the peak"),
    (r"tip_y_peak", "rise of the tip"), (r"deflection_3_across", "the same, 3 particles"),
         (r"deflection_5", "the same, 5 particles"), (r"ratio_1400_6", "the same, 6 particles"),
    (r"frequency_3", "the same, 3 particles"), (r"end_87.5", "deflection at 0.5 s"),
         (r"dz_levels", "deflection downward"),
    (r"uz_twice_6", "deflection across the stream"), (r"pitch_box_20", "pitch of the float"),
         (r"draft_0.25", "draft at a quarter of the density"),
    (r"ux_mean", "mean displacement along the flag"),
         (r"ux_amplitude", "its amplitude along the flag"),
         (r"^ux_", "displacement along the flag"),
    (r"forward_2", "volume of the second pulse"))


def collect(results):
    """What tools/run left in `results`, {"command", "scenes": {name: {"summary" or None}}}: all of
    one commit without changes."""
    found = {}
    for name in paths.scenes():
        path = Path(results) / name / "summary.json"
        found[name] = {"summary": json.loads(path.read_text()) if path.exists() else None}
    commits = {entry["summary"].get("commit") or "unknown" for entry in found.values()
               if entry["summary"]}
    if not commits:
        raise Refusal(f"{results} holds no summary.json of a scene: tools/run all makes them")
    if len(commits) > 1 or any(not re.fullmatch("[0-9a-f]+", commit) for commit in commits):
        raise Refusal(f"{results} holds results of {', '.join(sorted(commits))}: pages are of one "
                      "commit without changes (+); tools/run all renews the others")
    return {"command": "tools/run all", "scenes": found}


def title(name):
    """The heading of a scene's README."""
    path = paths.folder(name) / "README.md"
    return next((line.lstrip("# ") for line in path.read_text().splitlines()
                 if line.startswith("# ")), name) if path.exists() else name


def _page(name, up):
    """The link to a scene's page."""
    return f"{up}{paths.folder(name).parent.name}/{name}/README.md"


def scenes_of(page):
    """What the results.json of a folder has, by scene."""
    path = Path(page) / "results.json"
    return json.loads(path.read_text())["scenes"] if path.exists() else {}


def packed(found):
    """results.json as text, a line for each figure, numbers to nine digits."""
    text = re.sub(r"-?\d+\.\d{9,}(?:e[-+]\d+)?\b", lambda m: f"{float(m[0]):.9g}",
                  json.dumps(found, indent=1))
    return re.sub(r"\{[^{}\[\]]*\}", lambda m: re.sub(r"\s*\n\s*", " ", m[0]), text) + "\n"


def judged(entry):
    """The figures of a scene that have a target."""
    return [f for f in entry["summary"]["figures"] if f["target"] is not None]


def listed(entry):
    """Those that the first table lists: what is compared with a reference, and what is missed."""
    return [f for f in judged(entry) if kind(f["source"]) or f["reference"] is not None
            or not f["met"]]


def kind(source):
    """What a figure is compared with, one of KINDS; None without a reference."""
    if source is None:
        return None
    for name, start in KINDS:
        if re.match(start, source):
            return name
    raise Refusal(f"the source '{source}' begins with none of the kinds of references "
                  "(python/fsi/results.py, KINDS)")


def _named(entry):
    """A copy of a scene's entry in which a source that is "the same" as the one above is written
    out, and errors are positive where sizes are too large."""
    above, figures = None, []
    for f in entry["summary"]["figures"]:
        if f["reference"] and f["value"] is not None:
            f = f | {"relative_error": f["value"] / f["reference"] - 1.0}
        if f["source"] and f["source"].startswith("the same"):
            f = f | {"source": re.split(", test case|: ", above)[0]
                     + f["source"].removeprefix("the same")}
        else:
            above = f["source"] or above
        figures.append(f)
    return entry | {"summary": entry["summary"] | {"figures": figures}}


def outside(figures):
    """Those with a reference from outside."""
    return [f for f in figures if kind(f["source"]) not in (None, OWN)]


def ran(found):
    """{scene: entry} of those that have results."""
    return {name: _named(entry) for name, entry in found["scenes"].items() if entry["summary"]}


def share(figures):
    """How many of these are met: 3 of 4"""
    return f"{sum(f['met'] for f in figures)} of {len(figures)}"


def table(found):
    """results.csv: one line a figure."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow((*COLUMNS, "commit", "date"))
    for name, entry in ran(found).items():
        summary = entry["summary"]
        rows.writerows((name, f["name"], _short(f["value"]), f["unit"], _short(f["reference"]),
                        kind(f["source"]), f["source"],
                        _short(None if f["relative_error"] is None else 100 * f["relative_error"],
                               3), f["target"], f["met"],
                        summary["commit"], summary.get("date")) for f in summary["figures"]
                       if f["name"] not in COST)
    return text.getvalue()


def _short(value, digits=6):
    return f"{value:.{digits}g}" if isinstance(value, float) else value


def render(found, up="../../"):
    """The page as Markdown; `up` leads from it to the root."""
    scenes = ran(found)
    every = [f for entry in scenes.values() for f in judged(entry)]
    figures = sum(f["name"] not in COST for entry in scenes.values()
                  for f in entry["summary"]["figures"])
    hours = sum(core_seconds(entry["summary"]) for entry in scenes.values()) / 3600
    own = [f for f in every if kind(f["source"]) == OWN]
    checks = [f for f in every if not kind(f["source"])]
    lines = ["# Results", "",
             "What the scenes compute, next to experiments, theory, finite elements and other "
             "codes.",
             f"**Of the judged figures with a reference from outside, {share(outside(every))} are "
             "met.**",
             f"Of those judged by a run of this package {share(own)} are met, of self-checks "
             f"without a reference {share(checks)}.",
             f"All {len(set(scenes) & set(paths.examples()))} scenes and the hard cases together "
             f"take {hours:.1f} hours on one core.", "",
             "![Size of each figure's error over its target](results.png)", "",
             "Each dot is a figure that has a target. Right of the line the target is missed.", "",
             "- The error is relative to the reference. Where there is none, the target bounds the "
             "value itself.",
             "- *Experiment* is a measurement or a fit to measurements. *Theory* is a closed form "
             "or a reduced equation that is solved numerically.",
             "- *Finite elements* and *code* are other programs. *Own run* is this package with "
             "another setting, which is no independent reference.",
             "- CPU seconds are those of all runs of a scene on one core.",
             f"- All {figures} figures are in [results.csv](results.csv), with the "
             f"{len(every) - sum(len(listed(e)) for e in scenes.values())} "
             "self-checks that are met.", ""]
    missing = [name for name, entry in found["scenes"].items() if not entry["summary"]
               or entry["summary"].get("failed_cases")]
    if missing:
        lines += [f"**Failed, in part or as a whole: {', '.join(missing)}.**", ""]
    lines += ["## With a target", "", _table(scenes, up), "", "## With a reference and no target",
              "",
              "Coarse and comparison runs are here. The largest error can be large because the "
              "reference is close to zero.", "", _others(scenes, up)]
    return "\n".join(lines) + "\n"


def _table(scenes, up):
    rows = []
    for name, entry in scenes.items():
        for k, f in enumerate(listed(entry)):
            rows.append([f"[{title(name)}]({_page(name, up)})" if k == 0 else "", f"`{f['name']}`",
                         value(f), "" if f["reference"] is None else number(f["reference"]),
                         kind(f["source"]) or "none", _whole(deviation(f)), bound(f),
                         "yes" if f["met"] else "**no**",
                         f"{core_seconds(entry['summary']):,.0f}" if k == 0 else ""])
    return _markdown(["scene", "quantity", "computed", "reference", "kind", "error", "target",
                      "met", "CPU s"], rows)


def _others(scenes, up):
    """Of what has a reference and no target a line for each source, with the largest error; a line
    for what has neither."""
    rows = []
    for name, entry in scenes.items():
        start = f"[{title(name)}]({_page(name, up)})"
        groups = {}
        for f in entry["summary"]["figures"]:
            if f["target"] is None and f["reference"] is not None:
                groups.setdefault(f["source"], []).append(f)
        for source, figures in groups.items():
            size = sorted((f for f in figures if f["relative_error"] is not None),
                          key=lambda f: abs(f["relative_error"]))
            middle = f"{100 * abs(size[len(size) // 2]['relative_error']):.1f} %" if size else ""
            rows.append([start, source if kind(source) != OWN
                         else f"{OWN}: {source.removeprefix('our ')}", str(len(figures)),
                         _whole(middle),
                         f"{deviation(size[-1])} (`{size[-1]['name']}`)" if size else ""])
            start = ""
        if start and not judged(entry):
            rows.append([start, "none",
                         str(sum(f["name"] not in COST for f in entry["summary"]["figures"])), "",
                         ""])
    return _markdown(["scene", "reference", "figures", "median error", "largest error"], rows)


def core_seconds(ran):
    """CPU seconds of a run, or of all cases of a summary, on one core."""
    cases = ran.get("cases", {}).values() or [ran]
    return sum((case["cpu_seconds"] or 0) * (case["ranks"] or 1) for case in cases)


def main_figures():
    """{group: {scene: [{"figure", "words", "case", "title", "of"}]}}: what each scene is about,
    examples/main.json."""
    return json.loads((paths.EXAMPLES / "main.json").read_text())


def main_of(row, entry):
    """(figure, seconds of the run that gave it) of a row of examples/main.json; None without a
    result."""
    figure = next((f for f in entry["summary"]["figures"] if f["name"] == row["figure"]), None)
    of = entry["summary"].get("cases", {}).get(row["case"]) if "case" in row else entry["summary"]
    return None if figure is None or of is None else (figure, core_seconds(of))


def headlines(found, up):
    """The README's table: every scene of the first group whose main quantity has a reference."""
    rows, scenes = [], ran(found)
    for name, several in next(iter(main_figures().values())).items():
        for row in several:
            of = scenes.get(name) and main_of(row, scenes[name])
            what = f"[{row.get('title', title(name))}]({_page(name, up)})"
            if not of:
                rows.append([what, "no result", *[""] * 5])
            elif of[0]["reference"]:
                rows.append([what, *_headline(row, *of, scenes[name])])
    return _markdown(["scene", "main quantity", "reference", "error", "worst other", "targets met",
                      "time"], rows)


def _headline(row, figure, seconds, entry):
    """Cells: the main quantity, and of the others that have a target the one with the largest
    error; of all if none has."""
    others = [f for f in entry["summary"]["figures"] if re.fullmatch(row.get("of", ".*"), f["name"])
              and f["relative_error"] is not None and f is not figure]
    known = [f for f in judged(entry) if re.fullmatch(row.get("of", ".*"), f["name"])]
    worst = max([f for f in others if f["target"] is not None] or others,
                key=lambda f: abs(f["relative_error"]), default=None)
    return [f"{row['words']} {value(figure)}",
            f"{number(figure['reference'])} ({kind(figure['source'])})", _whole(deviation(figure)),
            f"{words(worst['name'])} {_whole(deviation(worst))}" if worst else "none",
            _whole(share(known)) if known else "none set", _whole(duration(seconds))]


def rule(found):
    """What the README says of its table."""
    scenes = ran(found)
    first = next(iter(main_figures().values()))
    shown = [name for name, rows in first.items()
             if any((of := name in scenes and main_of(row, scenes[name])) and of[0]["reference"]
                    for row in rows)]
    every = [f for entry in scenes.values() for f in judged(entry)]
    return [f"The table has the {len(shown)} of {len(paths.examples())} scenes in which a fluid "
            "moves an elastic body and the main quantity has a reference.",
            "*Worst other* is the further figure with the largest error, among those with a target "
            "if there are any. Times are those of the main run on one core.",
            f"Over all scenes {share(outside(every))} judged figures with a reference from outside "
            "are met: [results](doc/results/README.md)."]


def _whole(text):
    """Text that a narrow column does not break."""
    return text.replace(" ", WHOLE)


def words(figure):
    """What a figure's name says."""
    return next((text for pattern, text in WORDS if re.search(pattern, figure)),
                figure.replace("_", " "))


def _markdown(head, rows):
    """A table; columns of numbers at the right."""
    left = ("scene", "quantity", "kind", "met", "main quantity", "worst other")
    lines = [head, ["---" if name in left else "---:" for name in head], *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |"
                     for line in lines)


def value(figure):
    """A figure with its unit."""
    unit = figure["unit"]
    return f"{number(figure['value'])}{' ' if ' ' in unit else WHOLE}{unit}" if unit else number(
        figure["value"])


def duration(seconds):
    """Seconds, or minutes where they are many."""
    return f"{seconds:.0f} s" if seconds < 120 else f"{seconds / 60:.0f} min"


def run_times(text, name, summary):
    """A scene's README with the times of its commands made anew: of a case, of all, on one core
    unless the line says otherwise."""
    def timed(line):
        case, cores = line["case"], line["cores"] or ""
        ran = summary.get("cases", {}).get(case) if case else summary
        if ran is None:  # a case that has not been run for the page
            return line[0]
        seconds = core_seconds(ran)
        if match := re.search(r"on (\d+) cores", cores):
            seconds /= int(match[1])
        return f"{line['head']}{duration(max(1.0, seconds))}{cores}"

    return re.sub(rf"^(?P<head>tools/run {name}(?: case=(?P<case>\S+))?\s+#.*?)\b[\d.]+ "
                  r"(?:s|min)(?P<cores> on .*)?$", timed, text, flags=re.M)


def draw(found, path):
    """Size of the error over the target, a line for each scene."""
    scenes = {name: entry for name, entry in found["scenes"].items() if entry["summary"]
              and judged(entry)}
    least = 1e-3  # what is less stands at the left
    with plot.picture(path, 7.2, 0.21 * len(scenes) + 0.7) as figure:
        axes = figure.add_subplot()
        axes.axvspan(1.0, 1e3, color=plot.RED, alpha=0.08, linewidth=0)
        for k, entry in enumerate(scenes.values()):
            size = [abs((f["relative_error"] if f["reference"] else f["value"]) or 0.0)
                    / f["target"] if f["target"] else 0.0 if f["met"] else np.inf
                    for f in judged(entry)]
            for missed, colour in ((False, plot.GREEN), (True, plot.RED)):
                x = [min(max(s, least), 30.0) for s in size if (s > 1.0) == missed]
                axes.plot(x, [k] * len(x), "o", markersize=5, color=colour, markeredgecolor="white",
                          markeredgewidth=0.5)
        axes.axvline(1.0, color=plot.GREY, linewidth=1.0)
        axes.set_yticks(range(len(scenes)), [title(name) for name in scenes], fontsize=7.5)
        axes.set(xscale="log", xlim=(0.7 * least, 40.0), ylim=(len(scenes) - 0.4, -0.6),
                 xlabel="size of the error over its target")
        axes.set_xticks([1e-3, 1e-2, 0.1, 1.0, 10.0], ["0.001 or less", "0.01", "0.1", "1", "10"])
        axes.minorticks_off()
        figure.tight_layout()


def readme(text, found, up=""):
    """The repository's README with its table made anew."""
    before, rest = text.split(MARKS[0])
    made = "\n".join(rule(found)) + "\n\n" + headlines(found, up)
    return before + MARKS[0] + "\n" + made + "\n\n" + MARKS[1] + rest.split(MARKS[1])[1]
