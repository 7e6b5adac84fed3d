"""One page of all that a run left, for a browser: readable without its folder and without a
network."""

import base64
import io
import json
import re
from html import escape
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from . import dump, log, paths, plot, series
from .animate import draw
from .summary import RUN_FILE, bound, deviation, number

OUT = "report.html"
CURVES = 12  # thermo columns and series that are drawn, at most each
DUMP = 200e6  # bytes of a dump of which pictures are still made here
STYLE = """body{font:15px/1.5 sans-serif;color:#222;max-width:1100px;margin:2em auto;padding:0 1em}h1,h2{color:#1b5e96}
table{border-collapse:collapse}td,th{border:1px solid #d0d7de;padding:4px 10px;text-align:left;vertical-align:top}th{background:#f2f6fa}
td.n{text-align:right;white-space:nowrap}pre{background:#f6f8fa;padding:12px;white-space:pre-wrap;font-size:13px;line-height:1.35}
img{max-width:100%}.curves{display:flex;flex-wrap:wrap;gap:10px}.curves img{width:340px}.bad{color:#c23b3b;font-weight:bold}.good{color:#3a923a}
.warning{background:#fff4e5;border-left:4px solid #d1611a;padding:6px 12px;margin:6px 0}.error{background:#fdecea;border-left:4px solid #c23b3b;padding:6px 12px}"""


def _log(folder, name):
    """The log of a folder: of that name, else log.lammps, else the only log.* that there is; None
    if there is none."""
    if name:
        path = next((p for p in (folder / name, Path(name)) if p.is_file()), None)
        if path is None:
            raise ValueError(f"{folder} has no log {name}")
        return path
    found = [folder / "log.lammps"] if (folder / "log.lammps").exists() else sorted(
        p for p in folder.glob("log.*") if p.is_file())
    if len(found) > 1:
        raise ValueError(
            f"{folder} has more than one log: log={' or log='.join(p.name for p in found)}")
    return found[0] if found else None


def write(folder=".", out=None, log_name=None):
    """Makes the page of the run in `folder`; returns its path."""
    folder = Path(folder)
    if not folder.is_dir():
        raise ValueError(f"{folder} is not a folder")
    path = _log(folder, log_name)
    found = log.read(path) if path else None
    record = _json(folder / RUN_FILE)
    summary = _json(folder / "summary.json")
    if found is None and not summary:
        raise ValueError(f"{folder} has neither log.lammps nor summary.json, nor another log.*: "
                         "log=FILE names one")
    name = record.get("scene") or summary.get("scene") or folder.resolve().name
    parts = [_head(name, found, record, summary), _messages(found), _figures(summary, found),
             _pictures(folder), _curves(folder, found),
             _price(found), _cases(folder, summary)]
    out = Path(out) if out else folder / OUT
    out.write_text('<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><meta '
                   'name="viewport" content="width=device-width">'
                   f"<title>{escape(name)}</title><style>{STYLE}</style></head>\n<body>\n"
                   + "\n".join(filter(None, parts)) + "\n</body></html>\n")
    return out


def _json(path):
    return json.loads(path.read_text()) if path.exists() else {}


def _head(name, found, record, summary):
    """What was run, with which settings."""
    readme = paths.folder(name) / "README.md"
    lines = [line for line in (readme.read_text().splitlines() if readme.exists() else [])
             if line.strip()]
    title = lines[0].lstrip("# ") if lines else name
    text = [
        f"<h1>{escape(title)}{escape(': ' + record['case']) if record.get('case') else ''}</h1>"]
    if len(lines) > 1 and not lines[1].startswith(("#", "`")):
        text.append(f"<p>{escape(lines[1])}</p>")
    facts = []
    if found and found.finished:
        first = found.finished[0]
        steps, seconds = sum(run.steps for run in found.finished), sum(run.loop_seconds
                                                                       for run in found.finished)
        facts.append(f"{first.atoms:,} particles, {steps:,} steps, {seconds:.4g} s on "
                     f"{first.ranks} rank{'s' * (first.ranks > 1)}"
                     + (f", {first.atoms * steps / seconds:.3g} particle-steps per second"
                        if seconds else ""))
    elif found:
        facts.append('<span class="bad">no run came to its end</span>')
    version = found.version if found else summary.get("lammps")
    facts += [f"LAMMPS {escape(version)}" for version in [version]
              if version] + [f"commit {escape(c)}" for c in [record.get("commit")] if c]
    text.append(f"<p>{'; '.join(facts)}</p>")
    variables = record.get("variables") or summary.get("variables")
    if variables:
        given = record.get("given") or {}
        text.append("<p>" + ", ".join(
            f"{'<b>' * (k in given)}{escape(k)} = {escape(str(v))}{'</b>' * (k in given)}"
            for k, v in variables.items()) + "</p>")
    return "\n".join(text)


def _messages(found):
    """Warnings and errors of the log."""
    if found is None:
        return ""
    return "\n".join(
        [*(f'<div class="error">{escape(line)}</div>' for line in dict.fromkeys(found.errors)),
         *(f'<div class="warning">{escape(line)}</div>' for line in dict.fromkeys(found.warnings))])


def _figures(summary, found):
    """The summary's table; without a summary, what the deck printed."""
    rows = []
    if summary:
        head = ("figure", "value", "", "reference", "error", "target", "source")
        for f in summary["figures"]:
            met = {None: "", True: ' <span class="good">met</span>',
                   False: ' <span class="bad">missed</span>'}[f["met"]]
            rows.append([escape(f["name"]), number(f["value"]), escape(f["unit"]),
                         number(f["reference"], ""), deviation(f), escape(bound(f)) + met,
                         escape(f["source"] or "")])
    elif found and found.values:
        head = ("figure", "value")
        rows = [[escape(name), escape(number(value))] for name, value in found.values.items()]
    return "<h2>Figures</h2>\n" + _table(head, rows,
                                         ("value", "reference", "error")) if rows else ""


def _table(head, rows, numbers=()):
    lines = ["<tr>" + "".join(f"<th>{title}</th>" for title in head) + "</tr>"]
    lines += ["<tr>" + "".join(f'<td{" class=n" * (title in numbers)}>{cell}</td>'
                               for title, cell in zip(head, row)) + "</tr>" for row in rows]
    return "<table>\n" + "\n".join(lines) + "\n</table>"


def _image(data, alt):
    return (f'<img alt="{escape(alt)}" src="data:image/png;base64,'
            f'{base64.b64encode(data).decode()}">')


def _pictures(folder):
    """Those that the analysis or dump image left; if there are none, snapshots of a dump."""
    images = sorted(folder.glob("*.png"))
    numbered = [path for path in images if re.search(r"\.\d{3,}\.png$", path.name)]  # of dump image
    made = [_image(path.read_bytes(), path.stem) for path in images if path not in numbered]
    if numbered:
        some = sorted({round(k) for k in np.linspace(0, len(numbered) - 1, min(6, len(numbered)))})
        made.append('<div class="curves">'
                    + "\n".join(_image(numbered[k].read_bytes(), numbered[k].stem) for k in some)
                    + "</div>")
    if not made:
        for path in sorted([*folder.glob("*.dump"), *folder.glob("*.dump.gz")]):
            if path.stat().st_size < DUMP:
                try:
                    picture = io.BytesIO()
                    draw(picture, dump.some(path, 6), {})
                    made.append(_image(picture.getvalue(), path.name))
                except ValueError:  # no times, or no column to colour by: no picture
                    pass
    return "<h2>Pictures</h2>\n" + "\n".join(made) if made else ""


def _curves(folder, found):
    """Small plots of the thermo columns over the time, and of files of fix print and fix
    ave/time."""
    made = []
    if found and found.runs:
        table = {name: found.column(name)
                 for name in dict.fromkeys(name for run in found.runs for name in run.thermo)}
        time = next((name for name in ("v_time", "Time", "v_t", "Step") if name in table), None)
        if time:
            made += [_curve(table[time], values, time, name) for name, values in table.items()
                     if name not in (time, "Step", "Time", "CPULeft", "CPU", "Atoms", "Dt")
                     and len(values) == len(table[time]) > 2][:CURVES]
    for path in sorted([*folder.glob("*.csv"), *folder.glob("*.ave")]):
        try:
            table = series.read_any(path).columns
        except ValueError:  # another kind of table
            continue
        (first, x), *rest = table.items()
        made += [_curve(x, y, first, f"{name} ({path.name})") for name, y in rest if y.ndim == 1
                 and len(y) > 2][:CURVES]
    return '<h2>Curves</h2>\n<div class="curves">\n' + "\n".join(made) + "\n</div>" if made else ""


def _curve(x, y, label, title):
    """A small plot."""
    with matplotlib.rc_context({**plot.STYLE, "font.size": 8, "lines.linewidth": 1.1}):
        figure = Figure(figsize=(3.4, 2.1))
        axes = figure.add_subplot()
        axes.plot(x, y, color=plot.BLUE)
        axes.set_title(title.removeprefix("v_").removeprefix("c_").removeprefix("f_"), loc="left")
        axes.set_xlabel(label.removeprefix("v_"))
        figure.tight_layout()
        data = io.BytesIO()
        figure.savefig(data, format="png", dpi=110)
    return _image(data.getvalue(), title)


def _price(found):
    """What was on and what it cost: the log's lists of effects, the tables of fix fsi/report, or
    LAMMPS' own table of times."""
    if found is None:
        return ""
    text = ["<h2>What it cost</h2>"] if found.effects or found.finished else []
    text += [f"<pre>{escape(block)}</pre>" for block in dict.fromkeys(found.effects)]
    for k, run in enumerate(found.finished, start=1):
        block = run.cost or run.times
        if block:
            text.append((f"<h3>Run {k}</h3>" if len(found.finished) > 1 else "")
                        + f"<pre>{escape(block)}</pre>")
    return "\n".join(text)


def _cases(folder, summary):
    """Links to the pages of a study's cases."""
    rows = [[f'<a href="{escape(name)}/{OUT}">{escape(name)}</a>' if (folder / name / OUT).exists()
             else escape(name), number(case.get("particles")),
             number(case.get("steps")), number(case.get("cpu_seconds"))]
            for name, case in summary.get("cases", {}).items()]
    return "<h2>Cases</h2>\n" + _table(("case", "particles", "steps", "seconds"), rows,
                                       ("particles", "steps", "seconds")) if rows else ""
