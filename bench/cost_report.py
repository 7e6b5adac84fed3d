"""What a sweep says: its table of points, what each error bound costs, the picture and the page."""

import json
import re
from datetime import date

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator
from tool import write_csv

from fsi import plot, scene, sweep
from fsi.precision import crossings, extrapolate, order, pareto, reach

BOUNDS = (10.0, 5.0, 2.0, 1.0)  # per cent
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREEN, "#7b4fa3", plot.RED, "#8c6d31", "#2ba3b4", "#444444",
           "#b5b535", "#e377c2")
NOISE = 0.2  # times that differ by less count as equal
MOVING = "still moving"  # among a run's figures: series.still_moving() of what is measured
# column: relative difference to a figure from outside that does not judge the discretisation
BESIDE = "to_outside"
COLUMNS = ("role", "group", "label", "x", "status", "value", "error", "crossing", "front",
           "cpu_seconds", "spread", "repeats", "dx",
           "particles", "steps", "particle_steps", "pair_visits", "instructions_per_particle_step",
           "instructions_per_pair_visit", "why")


def write(folder, name, definition, points, source):
    """points.csv, summary.json, picture and page into `folder`; returns the summary."""
    folder.mkdir(parents=True, exist_ok=True)
    reference, about, finest = _reference(definition, points)
    rows = [_row(definition, point, reference, finest) for point in points]
    curves = _curves(definition, rows)
    for curve in curves.values():
        for row, flag in zip(curve, crossings([row["error"] for row in curve])):
            row["crossing"] = bool(flag)
    candidates = [r for r in rows if r["status"] == "ok" and r["role"] in ("curve", "corner")
                  and not r["crossing"]]
    for k in pareto([r["cpu_seconds"] for r in candidates], [abs(r["error"]) for r in candidates],
                    NOISE):
        candidates[k]["front"] = True
    certain = 2.0 * (about.get("uncertainty") or 0.0) / abs(reference or 1.0)
    spreads = [r["spread"] for r in rows if r["spread"] is not None]
    resolution = definition["resolution"]
    summary = {
        "scene": name, "title": definition["title"], "figure": definition["figure"],
        "label": definition["label"], "unit": definition.get("unit", ""),
        "variable": resolution["variable"], "finer": resolution["finer"],
        "resolution": resolution["text"], "notes": definition.get("notes", ""), "reference": about,
        "command": definition["command"], "source": source, "commit": scene.commit() if source
        == sweep.source_hash() else None,
        "date": date.today().isoformat(),
        "points": len(rows), "failed": sum(r["status"] == "failed" for r in rows),
        "spread": float(np.median(spreads)) if spreads else None,
        "cpu_seconds": sum({json.dumps(p["run"]["settings"]): sum(p["run"]["cpu_seconds"])
                            for p in points}.values()),
        "methods": {method: _method(definition, curve, certain)
                    for method, curve in curves.items()},
        "thinnest": _thinnest(rows),
        "moving": {row["label"]: share for row in rows
                   if (share := row["point"]["figures"].get(MOVING)) is not None}}
    further = [*definition.get("also", ()), *([BESIDE] if "beside" in definition else [])]
    write_csv(folder / "points.csv", definition["command"], [*COLUMNS[:-1], *further, COLUMNS[-1]],
              rows)
    (folder / "summary.json").write_text(json.dumps(summary, indent=1, default=float) + "\n")
    draw(folder / "work.png", summary, rows)
    (folder / "page.md").write_text(page(summary, "work.png", "points.csv"))
    return summary


def moving(summary):
    """What is said of figures that neither swung back nor came to rest."""
    runs = ", ".join(f"{label} ({100 * share:.2g} %)" for label, share in summary["moving"].items())
    return (f"{summary['figure']} has not yet swung in {runs}: by so much of its range it still "
            "went on in the last tenth of the run. "
            "Let the deck run longer")


# ---- from points to figures ----

def _value(definition, run):
    """The measured figure; None where the run failed or the definition says that it did."""
    return None if run["status"] != "ok" or _invalid(definition, run) else run["figures"].get(
        definition["figure"])


def _invalid(definition, run):
    """Why a run that came to its end does not count, by failed_if: a list of figures, or {figure:
    largest value}; else None."""
    limits = definition.get("failed_if", ())
    for name in limits:
        value = run["figures"].get(name)
        if value is not None and (not isinstance(limits, dict) or value > limits[name]):
            return f"{name} = {value:.3g}"
    return None


def _reference(definition, points):
    """(reference value, or None where the figure is an error itself; what it is; the point that it
    is, if it is one)."""
    given = definition.get("reference")
    if given is not None:
        value = given.get("value")
        if value is None:
            value = next((p["run"]["figures"][f"{definition['figure']} reference"] for p in points
                          if f"{definition['figure']} reference" in p["run"]["figures"]), None)
        return value or None, {"kind": "outside", "value": value, "source": given["source"]}, None
    first = next(iter(definition["methods"]))
    curve = [p for p in points
             if p["role"] == "curve" and p["group"] == first
             and _value(definition, p["run"]) is not None]
    if not curve:
        return None, {"kind": "none", "value": None,
                      "source": f"no run of '{first}' gave a value"}, None
    curve.sort(key=lambda p: _size(definition, p["x"]), reverse=True)
    sizes, values = [_size(definition, p["x"]) for p in curve], [_value(definition, p["run"])
                                                                 for p in curve]
    limit = extrapolate(sizes, values)
    if limit is None:
        about = f"the finest run of '{first}', {values[-1]:.5g}"
        step = abs(values[-1] - values[-2]) if len(values) > 1 else None
        return values[-1], {"kind": "finest", "value": values[-1], "uncertainty": step,
                            "source": about}, curve[-1]
    value, power, uncertainty = limit
    about = (f"Richardson extrapolation of '{first}': {value:.5g}, uncertain by {uncertainty:.1g}, "
             f"order {power:.2f}")
    return value, {"kind": "extrapolated", "value": value, "order": power,
                   "uncertainty": uncertainty, "source": about}, None


def _size(definition, x):
    """Length that falls with refinement, from a value of the resolution."""
    return size_of(definition["resolution"]["finer"], x)


def size_of(finer, x):
    """The same, from what `finer` says: up or down."""
    return 1.0 / float(x) if finer == "up" else float(x)


def _row(definition, point, reference, finest):
    run, value = point["run"], _value(definition, point["run"])
    seconds = run["cpu_seconds"]
    row = dict.fromkeys(COLUMNS) | {"point": run} | {key: point[key]
                                                     for key in ("role", "group", "label", "x")}
    row |= {key: run.get(key)
            for key in ("dx", "particles", "steps", "particle_steps", "pair_visits")}
    row |= {"status": "failed", "why": run["why"] or _invalid(definition, run)
            or "no valid figure"} if value is None else {"status": "ok"}
    row |= {"value": value, "crossing": False, "front": False, "repeats": len(seconds)}
    if value is not None:
        row["error"] = (value - reference) / abs(reference) if reference else value
        if point is finest:  # it is 0 by definition
            row |= {"status": "reference", "error": None}
        # not the least: clocks of short runs err to both sides
        row["cpu_seconds"] = float(np.median(seconds))
        if len(seconds) > 1 and min(seconds):
            row["spread"] = (max(seconds) - min(seconds)) / min(seconds)
        row |= {name: run["figures"].get(name) for name in definition.get("also", ())}
        if "beside" in definition:
            row[BESIDE] = value / definition["beside"]["value"] - 1.0
        if counted := run.get("instructions"):
            row["instructions_per_particle_step"] = (counted["instructions"]
                                                     / counted["particle_steps"])
            if counted["pair_visits"]:
                row["instructions_per_pair_visit"] = (counted["instructions"]
                                                      / counted["pair_visits"])
    return row


def _curves(definition, rows):
    """{method: its rows from coarse to fine}, those that gave a figure."""
    good = [r for r in rows if r["role"] == "curve" and r["status"] == "ok"]
    return {name: sorted((r for r in good if r["group"] == name),
                         key=lambda r: _size(definition, r["x"]), reverse=True)
            for name in definition["methods"]}


def _method(definition, curve, certain):
    """Order of convergence, and what each error bound costs; bounds below `certain` are beyond what
    the reference can judge."""
    h = [_size(definition, r["x"]) for r in curve]
    error = [r["error"] for r in curve]
    fit = order(h, error)
    found = {"order": fit and fit[0], "order_interval": fit and fit[1],
             "sign_changes": bool(np.any(crossings(error))), "bounds": {}}
    counted = next((r for r in curve if r["instructions_per_particle_step"]), None)
    found["instructions"] = counted and {
        "at": counted["x"], "steps": counted["point"]["instructions"]["steps"],
        "per_particle_step": counted["instructions_per_particle_step"],
        "per_pair_visit": counted["instructions_per_pair_visit"]}
    # one run alone shows no trend that would keep a bound
    for bound in BOUNDS if len(curve) > 1 else ():
        k = reach(error, bound / 100.0)
        if bound / 100.0 < certain:
            continue
        if k is not None:
            found["bounds"][f"{bound:g}"] = {
                "at": curve[k]["x"], "error": max(map(abs, error[k:])),
                "cpu_seconds": curve[k]["cpu_seconds"],
                "particle_steps": curve[k]["particle_steps"], "kind": "coarsest run" if k == 0
                else "run"}
        elif fit and fit[0] - fit[1] > 0.2 and not found["sign_changes"]:
            size = (bound / 100.0 / fit[2])**(1.0 / fit[0])
            slope = np.polyfit(np.log(h[-3:]), np.log([r["cpu_seconds"] for r in curve[-3:]]), 1)[0]
            at = 1.0 / size if definition["resolution"]["finer"] == "up" else size
            if size > h[-1] / 4.0:  # further away it means nothing
                seconds = curve[-1]["cpu_seconds"] * (size / h[-1])**slope
                found["bounds"][f"{bound:g}"] = {"at": at, "error": bound / 100.0,
                                                 "cpu_seconds": seconds,
                                                 "particle_steps": None, "kind": "extrapolated"}
    return found


def _thinnest(rows):
    """{value of the resolution: extent of the thinnest body in particles}; none if methods have
    bodies of several."""
    found = {}
    for row in rows:
        if row["role"] == "curve":
            sizes = [min(body[2]) for body in row["point"].get("bodies") or ()
                     if body[0].startswith("body") and body[2]]
            if sizes:
                found.setdefault(f"{row['x']:.4g}", set()).add(round(float(min(sizes)), 2))
    return {} if any(len(sizes) > 1 for sizes in found.values()) else {
        x: size for x, (size,) in found.items()}


# ---- picture ----

def few_labels(axis):
    """Plain numbers at 1, 2, 5 of a logarithmic axis that spans little, at the decades of one that
    spans much."""
    low, high = axis.get_view_interval()
    decades = np.log10(high / low)
    subs = (1.0, 2.0, 5.0) if decades < 1.6 else (1.0, 3.0) if decades < 2.5 else (1.0,)
    axis.set_major_locator(LogLocator(subs=subs, numticks=20))
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(FuncFormatter(_plain))


def _plain(value, _=None):
    if value < 1.0e4:
        return f"{value:g}"
    power = int(np.floor(np.log10(value) + 1e-9))
    front = f"{value / 10.0**power:.0f}"
    return f"$10^{{{power}}}$" if front == "1" else rf"${front}\cdot10^{{{power}}}$"


def names_at_ends(axes, ends, size=7.5):
    """Names of curves beside their right ends, (x, y, name, colour) on logarithmic axes, moved
    apart where they would overlap."""
    low, high = np.log(axes.get_ylim())
    height = axes.get_position().height * axes.figure.get_size_inches()[1]
    step = 1.25 * size / 72.0 / height
    ends = sorted(ends, key=lambda end: end[1])
    place = [(np.log(y) - low) / (high - low) for _, y, _, _ in ends]
    for _ in range(200):
        for k in range(len(place) - 1):
            if (close := step - (place[k + 1] - place[k])) > 0.0:
                place[k], place[k + 1] = place[k] - 0.5 * close, place[k + 1] + 0.5 * close
    for (x, y, name, colour), at in zip(ends, place):
        axes.annotate(name, (x, y), (1.03, at), "data", "axes fraction", color=colour,
                      fontsize=size, va="center", annotation_clip=False,
                      arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.5,
                                  "alpha": 0.6, "shrinkA": 0, "shrinkB": 3})


def curves_of(rows, methods, finer):
    """{method: its rows that have an error, from coarse to fine}"""
    return {name: sorted((r for r in rows if r["role"] == "curve" and r["group"] == name
                          and r["error"] is not None), key=lambda r: -size_of(finer, r["x"]))
            for name in methods}


def one_curve(axes, curve, x, colour):
    """A curve of errors; open symbols where the error changes its sign."""
    y = np.array([100 * abs(r["error"]) for r in curve])
    hollow = np.array([bool(r["crossing"]) for r in curve])
    axes.plot(x, y, "-", color=colour, zorder=3, linewidth=1.4)
    axes.plot(x[~hollow], y[~hollow], "o", color=colour, markersize=4.5, zorder=4)
    axes.plot(x[hollow], y[hollow], "o", color=colour, markersize=4.5, markerfacecolor="white",
              zorder=4)


def draw(path, summary, rows):
    """Error against resolution and against CPU time, a curve for each method."""
    curves = {name: curve for name, curve in curves_of(rows, summary["methods"],
                                                       summary["finer"]).items() if curve}
    with plot.picture(path, 9.2, 3.6) as figure:
        left, right = figure.subplots(1, 2, sharey=True)
        figure.subplots_adjust(left=0.075, right=0.70, top=0.96, bottom=0.15, wspace=0.08)
        ends = []
        for (name, curve), colour in zip(curves.items(), COLOURS):
            one_curve(left, curve, np.array([size_of(summary["finer"], r["x"]) for r in curve]),
                      colour)
            one_curve(right, curve, np.array([r["cpu_seconds"] for r in curve]), colour)
            ends.append((curve[-1]["cpu_seconds"], 100 * abs(curve[-1]["error"]), name, colour))
        values = [r["x"] for curve in curves.values() for r in curve]
        for axes in (left, right):
            axes.set(xscale="log", yscale="log")
            low, high = axes.get_ylim()
            axes.axhspan(1e-9, 1.0, color=plot.GREEN, alpha=0.08, linewidth=0)
            if floor := summary["reference"].get("uncertainty"):
                axes.axhspan(1e-9, 200 * floor / abs(summary["reference"]["value"]), color="black",
                             alpha=0.08, linewidth=0)
            axes.set_ylim(min(low, 0.5), max(high, 2.0))
        if values:
            sizes = {size_of(summary["finer"], v): v for v in values}
            _ticks(left, sizes)
            if summary["finer"] == "down":
                left.invert_xaxis()
        few_labels(right.xaxis)
        few_labels(left.yaxis)
        left.set(xlabel=summary["resolution"], ylabel=f"{summary['label']} [%]")
        if summary["finer"] == "up":
            left.invert_xaxis()
        right.set_xlabel("CPU time [s]")
        names_at_ends(right, ends)


def _ticks(axes, sizes):
    """Marks the resolutions that were run, {size: value}, as many as there is room for."""
    room = 0.13 * np.log(max(sizes) / min(sizes))
    ticks = []
    for size in sorted(sizes):
        if not ticks or np.log(size / ticks[-1]) > room:
            ticks.append(size)
    axes.set_xticks(ticks, [f"{sizes[t]:.3g}" for t in ticks])
    axes.xaxis.set_minor_locator(NullLocator())


# ---- text ----

def _order(method):
    """The order of convergence as text; an interval that holds 0 says that none was seen."""
    if method["order"] is None:
        return "-"
    return f"{method['order']:.2f} ± {method['order_interval']:.2f}" if abs(
        method["order"]) > method["order_interval"] else "none"


def seconds(value):
    """CPU seconds as text."""
    return f"{value:.2g} s" if value < 100 else f"{value:.0f} s"


def cell(entry):
    """What keeping a bound costs, and the resolution."""
    if entry is None:
        return "-"
    at = f"{entry['at']:.4g}" if entry["kind"] != "extrapolated" else f"{entry['at']:.2g}"
    text = f"{seconds(entry['cpu_seconds'])} ({at})"
    return {"coarsest run": f"< {text}", "extrapolated": f"*{text}*"}.get(entry["kind"], text)


def page(summary, picture, table):
    """The page as Markdown; picture and table: files beside it."""
    about = summary["reference"]
    judged = {"outside": f"Reference: {about['source']}.",
              "finest": f"Reference: {about['source']}. It is not an independent reference.",
              "extrapolated": f"Reference: {about['source']}. It is not an independent reference.",
              "none": f"No reference: {about['source']}."}[about["kind"]]
    lines = [f"# What accuracy costs: {summary['title']}", "",
             f"Judged is the {summary['label']} (`{summary['figure']}`).", judged]
    if about.get("uncertainty") and about["kind"] != "outside":
        lines.append(f"It is uncertain by {100 * about['uncertainty'] / abs(about['value']):.1g} "
                     "%; twice that is the gray band of the picture.")
    lines += re.split(r"(?<=[.:]) (?=[A-Z])", summary["notes"]) if summary["notes"] else []
    if any(re.search(r"\b[TU]L\b", name) for name in summary["methods"]):
        lines.append("TL and UL: total and updated Lagrangian.")
    lines += ["", *([f"**Warning**: {moving(summary)}.", ""] if summary["moving"] else []),
              f"![Error against resolution and against CPU time]({picture})", "",
              "- Time: " + ("each point is one run." if summary["spread"] is None else "median of "
                            f"up to three runs, which differ by {100 * summary['spread']:.0f} %."),
              f"- All {summary['points']} runs: [{table}]({table}). {summary['failed']} stopped or "
              "do not count."]
    if summary.get("thinnest") and any(f"{size:g}" != x for x, size in summary["thinnest"].items()):
        lines.append(f"- The thinnest body has, at {summary['variable']} = "
                     + ", ".join(f"{x}: {size:g}" for x, size in summary["thinnest"].items())
                     + " particles through its thickness.")
    lines += ["", "CPU seconds that keep an error bound. In brackets the resolution: "
              f"`{summary['variable']}`"
              + (f", {summary['resolution']}:" if summary["resolution"] != summary["variable"]
                 else ":"), "",
              "| method | order | 10 % | 5 % | 2 % | 1 % | instructions per particle-step |",
              "|---|---|---|---|---|---|---|"]
    for method, found in summary["methods"].items():
        cells = [cell(found["bounds"].get(f"{b:g}")) for b in BOUNDS]
        counted = (found["instructions"] or {}).get("per_particle_step")
        lines.append(f"| {method} | {_order(found)} | " + " | ".join(cells)
                     + f" | {f'{counted:.0f}' if counted else '-'} |")
    lines += ["", "[How to read this page](README.md#how-to-read-the-pages)."]
    return "\n".join(lines) + "\n"
