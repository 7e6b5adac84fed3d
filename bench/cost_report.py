"""Figures, pictures and the page of a sweep, from its points."""

import json
import shutil

import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter, NullLocator

from tool import PAGE, write_csv

from fsi import plot, scene, sweep
from fsi.precision import crossings, extrapolate, order, pareto, reach

BOUNDS = (10.0, 5.0, 2.0, 1.0)  # per cent
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREEN, "#7b4fa3", plot.RED, "#8c6d31", "#2ba3b4", "#444444")
MANY = 12  # bodies that a table lists
NOISE = 0.2  # times that differ by less count as equal
SAME = 1.1  # errors that differ by less than this factor count as equal
MOVING = "still moving"  # among a run's figures: series.still_moving() of what is measured
BESIDE = "to_outside"  # column: relative difference to a figure from outside that does not judge the discretisation
COLUMNS = ("role", "group", "label", "x", "status", "value", "error", "crossing", "front", "cpu_seconds", "spread", "repeats", "dx",
           "particles", "steps", "particle_steps", "pair_visits", "instructions_per_particle_step", "instructions_per_pair_visit", "why")


def write(folder, name, definition, points, source):
    """Everything into `folder`; returns the summary."""
    folder.mkdir(parents=True, exist_ok=True)
    reference, about, finest = _reference(definition, points)
    rows = [_row(definition, point, reference, finest) for point in points]
    curves = _curves(definition, rows)
    for curve in curves.values():
        for row, flag in zip(curve, crossings([row["error"] for row in curve])):
            row["crossing"] = bool(flag)
    candidates = [r for r in rows if r["status"] == "ok" and r["role"] in ("curve", "corner") and not r["crossing"]]
    for k in pareto([r["cpu_seconds"] for r in candidates], [abs(r["error"]) for r in candidates], NOISE):
        candidates[k]["front"] = True
    certain = 2.0 * (about.get("uncertainty") or 0.0) / abs(reference or 1.0)
    methods = {name: _method(definition, curve, certain) for name, curve in curves.items()}
    summary = {
        "scene": name, "title": definition["title"], "figure": definition["figure"], "reference": about,
        "command": definition["command"],
        "source": source, "commit": scene.commit() if source == sweep.source_hash() else None,
        "points": len(rows), "failed": sum(r["status"] == "failed" for r in rows),
        "spread": float(np.median(spreads)) if (spreads := [r["spread"] for r in rows if r["spread"] is not None]) else None,
        "cpu_seconds": sum({json.dumps(p["run"]["settings"]): sum(p["run"]["cpu_seconds"]) for p in points}.values()),
        "methods": methods, "knobs": _knobs(definition, rows), "reach": _reach(methods),
        "moving": {row["label"]: share for row in rows if (share := row["point"]["figures"].get(MOVING)) is not None}}
    summary["recommendation"] = _recommendation(definition, summary, rows)
    write_csv(folder / "points.csv", [*COLUMNS[:-1], *_further(definition), COLUMNS[-1]], rows)
    (folder / "summary.json").write_text(json.dumps(summary, indent=1, default=float) + "\n")
    _draw_work(folder / "work.png", definition, rows, curves, methods)
    if definition.get("knobs"):
        _draw_knobs(folder / "knobs.png", definition, rows)
    if any(row["role"] == "effect" for row in rows):
        _draw_effects(folder / "effects.png", definition, rows)
    (folder / "page.md").write_text(_page(definition, summary, rows, curves))
    return summary


def publish(folder, name):
    """Copies a scene's page, pictures and tables to doc/cost and renews the list there."""
    PAGE.mkdir(parents=True, exist_ok=True)
    page = (folder / "page.md").read_text().replace("[points.csv](points.csv)", f"[{name}.csv]({name}.csv)")
    for file in ("work.png", "knobs.png", "effects.png"):
        if (folder / file).exists():
            shutil.copyfile(folder / file, PAGE / f"{name}_{file}")
            page = page.replace(f"]({file})", f"]({name}_{file})")
    shutil.copyfile(folder / "points.csv", PAGE / f"{name}.csv")
    shutil.copyfile(folder / "summary.json", PAGE / f"{name}.json")
    (PAGE / f"{name}.md").write_text(page)
    (PAGE / "README.md").write_text(_index())


def moving(summary):
    """What is said of figures that neither swung back nor came to rest."""
    runs = ", ".join(f"{label} ({100 * share:.2g} %)" for label, share in summary["moving"].items())
    return (f"{summary['figure']} has not yet swung in {runs}: by so much of its range it still went on in the last tenth of the run. "
            "Let the deck run longer")


# ---- from points to figures ----

def _value(definition, run):
    """The measured figure; None where the run failed or the definition says that it did."""
    return None if run["status"] != "ok" or _invalid(definition, run) else run["figures"].get(definition["figure"])


def _invalid(definition, run):
    """Why a run that came to its end does not count, by failed_if: a list of figures, or {figure: largest value}; else None."""
    limits = definition.get("failed_if", ())
    for name in limits:
        value = run["figures"].get(name)
        if value is not None and (not isinstance(limits, dict) or value > limits[name]):
            return f"{name} = {value:.3g}"
    return None


def _reference(definition, points):
    """(reference value, or None where the figure is an error itself; what it is; the point that it is, if it is one)."""
    given = definition.get("reference")
    if given is not None:
        value = given.get("value")
        if value is None:
            value = next((p["run"]["figures"][f"{definition['figure']} reference"] for p in points
                          if f"{definition['figure']} reference" in p["run"]["figures"]), None)
        return value or None, {"kind": "outside", "value": value, "source": given["source"]}, None
    first = next(iter(definition["methods"]))
    curve = [p for p in points
             if p["role"] == "curve" and p["group"] == first and _value(definition, p["run"]) is not None]
    if not curve:
        return None, {"kind": "none", "value": None, "source": f"no run of '{first}' gave a value"}, None
    curve.sort(key=lambda p: _size(definition, p["x"]), reverse=True)
    sizes, values = [_size(definition, p["x"]) for p in curve], [_value(definition, p["run"]) for p in curve]
    limit = extrapolate(sizes, values)
    if limit is None:
        about = f"the finest run of '{first}', {values[-1]:.5g}: the values do not approach a limit that could be extrapolated"
        step = abs(values[-1] - values[-2]) if len(values) > 1 else None
        if step is not None:
            about += f"; the last refinement changed it by {100 * step / abs(values[-1]):.1g} %, and errors mean no less than that"
        return values[-1], {"kind": "finest", "value": values[-1], "uncertainty": step, "source": about}, curve[-1]
    value, power, uncertainty = limit
    about = (f"Richardson extrapolation of '{first}': {value:.5g}, uncertain by {uncertainty:.1g}, order {power:.2f}. "
             "This is convergence to itself, not agreement with an outside truth")
    return value, {"kind": "extrapolated", "value": value, "order": power, "uncertainty": uncertainty, "source": about}, None


def _size(definition, x):
    """Length that falls with refinement, from a value of the resolution."""
    return 1.0 / float(x) if definition["resolution"]["finer"] == "up" else float(x)


def _row(definition, point, reference, finest):
    run, value = point["run"], _value(definition, point["run"])
    seconds = run["cpu_seconds"]
    row = dict.fromkeys(COLUMNS) | {"point": run} | {key: point[key] for key in ("role", "group", "label", "x")}
    row |= {key: run.get(key) for key in ("dx", "particles", "steps", "particle_steps", "pair_visits")}
    row |= {"status": "failed", "why": run["why"] or _invalid(definition, run) or "no valid figure"} if value is None else {"status": "ok"}
    row |= {"value": value, "crossing": False, "front": False, "repeats": len(seconds)}
    if value is not None:
        row["error"] = (value - reference) / abs(reference) if reference else value
        if point is finest:  # it is 0 by definition
            row |= {"status": "reference", "error": None}
        row["cpu_seconds"] = float(np.median(seconds))  # not the least: clocks of short runs err to both sides
        if len(seconds) > 1 and min(seconds):
            row["spread"] = (max(seconds) - min(seconds)) / min(seconds)
        row |= {name: run["figures"].get(name) for name in definition.get("also", ())}
        if "beside" in definition:
            row[BESIDE] = value / definition["beside"]["value"] - 1.0
        if counted := run.get("instructions"):
            row["instructions_per_particle_step"] = counted["instructions"] / counted["particle_steps"]
            if counted["pair_visits"]:
                row["instructions_per_pair_visit"] = counted["instructions"] / counted["pair_visits"]
    return row


def _further(definition):
    """Columns of figures beside the one that is judged: {column: heading}."""
    found = dict(definition.get("also", {}))
    if "beside" in definition:
        found[BESIDE] = f"to {definition['beside']['source']}"
    return found


def _further_cells(definition, row):
    return "".join(" - |" if row.get(name) is None else f" {_percent(row[name])} |" if name == BESIDE else f" {row[name]:.2g} |"
                   for name in _further(definition))


def _curves(definition, rows):
    """{method: its rows from coarse to fine}, those that gave a figure."""
    good = [r for r in rows if r["role"] == "curve" and r["status"] == "ok"]
    return {name: sorted((r for r in good if r["group"] == name), key=lambda r: _size(definition, r["x"]), reverse=True)
            for name in definition["methods"]}


def _method(definition, curve, certain):
    """Order of convergence, and what each error bound costs; bounds below `certain` are beyond what the reference can judge."""
    h = [_size(definition, r["x"]) for r in curve]
    error = [r["error"] for r in curve]
    fit = order(h, error)
    found = {"order": fit and fit[0], "order_interval": fit and fit[1], "sign_changes": bool(np.any(crossings(error))), "bounds": {}}
    counted = next((r for r in curve if r["instructions_per_particle_step"]), None)
    found["instructions"] = counted and {
        "at": counted["x"], "steps": counted["point"]["instructions"]["steps"],
        "per_particle_step": counted["instructions_per_particle_step"], "per_pair_visit": counted["instructions_per_pair_visit"]}
    for bound in BOUNDS if len(curve) > 1 else ():  # one run alone shows no trend that would keep a bound
        k = reach(error, bound / 100.0)
        if bound / 100.0 < certain:
            continue
        if k is not None:
            found["bounds"][f"{bound:g}"] = {
                "at": curve[k]["x"], "error": max(map(abs, error[k:])), "cpu_seconds": curve[k]["cpu_seconds"],
                "particle_steps": curve[k]["particle_steps"], "kind": "coarsest run" if k == 0 else "run"}
        elif fit and fit[0] - fit[1] > 0.2 and not found["sign_changes"]:
            size = (bound / 100.0 / fit[2])**(1.0 / fit[0])
            slope = np.polyfit(np.log(h[-3:]), np.log([r["cpu_seconds"] for r in curve[-3:]]), 1)[0]
            at = 1.0 / size if definition["resolution"]["finer"] == "up" else size
            if size > h[-1] / 4.0:  # further away it means nothing
                seconds = curve[-1]["cpu_seconds"] * (size / h[-1])**slope
                found["bounds"][f"{bound:g}"] = {"at": at, "error": bound / 100.0, "cpu_seconds": seconds,
                                                 "particle_steps": None, "kind": "extrapolated"}
    return found


def _knobs(definition, rows):
    """What turning each knob does, compared with the base."""
    found = {}
    for knob in definition.get("knobs", ()):
        mine = [r for r in rows if r["role"] == "knob" and r["group"] == knob["name"]]
        good = [r for r in mine if r["status"] == "ok"]
        base = _base(knob, rows)
        if base is None or not good:
            continue
        same = [r for r in good if abs(r["error"]) <= SAME * abs(base["error"])]
        cheapest = min(same, key=lambda r: r["cpu_seconds"], default=base)
        best = min(good, key=lambda r: abs(r["error"]))
        short = lambda r: {"value": r["x"], "error": r["error"], "cpu_seconds": r["cpu_seconds"]}
        errors = [abs(r["error"]) for r in good]
        found[knob["name"]] = {
            "base": short(base) | {"of": knob["of"], "at": knob["at"]}, "cheapest_as_good": short(cheapest),
            "lowest_error": short(best), "ran": [r["x"] for r in good],
            "failed": [r["x"] for r in mine if r["status"] == "failed"], "error_range": [min(errors), max(errors)],
            "flat": _flat(base, good), "optimum": _optimum(good)}
    return found


def _same(base, rows):
    """Those of a knob's rows that are its base: the same point, or the same run by settings that say more."""
    return ([r for r in rows if r["point"] == base["point"]]
            or [r for r in rows if (r["value"], r["steps"]) == (base["value"], base["steps"])][:1])


def _numbers(rows):
    """The rows in order of their values; none where values are words."""
    return sorted(rows, key=lambda r: r["x"]) if all(isinstance(r["x"], (int, float)) for r in rows) else []


def _flat(base, good):
    """[least, largest] value about the base over which the error is that of the base; None for words or a single value."""
    ordered = _numbers(good)
    here = next((k for k, r in enumerate(ordered) if r in _same(base, good)), None)
    if here is None:
        return None
    low = high = here
    near = lambda r: abs(base["error"]) / SAME <= abs(r["error"]) <= SAME * abs(base["error"])
    while low > 0 and near(ordered[low - 1]):
        low -= 1
    while high + 1 < len(ordered) and near(ordered[high + 1]):
        high += 1
    return [ordered[low]["x"], ordered[high]["x"]] if high > low else None


def _optimum(good):
    """The value of least error if errors rise to both of its sides and have one sign, so that it is no change of sign; else None."""
    ordered = _numbers(good)
    errors = [r["error"] for r in ordered]
    if len(ordered) < 3 or min(errors) * max(errors) <= 0.0:
        return None
    size = np.abs(errors)
    k = int(np.argmin(size))
    return ordered[k]["x"] if size[0] > SAME * size[k] and size[-1] > SAME * size[k] else None


def _base(entry, rows):
    """The run of a method's curve that a knob or effect starts from."""
    return next((r for r in rows if r["role"] == "curve" and r["status"] == "ok"
                 and (r["group"], r["x"]) == (entry["of"], entry["at"])), None)


def _reach(methods):
    """{bound: methods that keep it, cheapest first}; the most accurate of those within a quarter of the least time leads."""
    found = {}
    for bound in map("{:g}".format, BOUNDS):
        entries = sorted(({"method": n, **m["bounds"][bound]} for n, m in methods.items() if bound in m["bounds"]),
                         key=lambda e: (e["kind"] == "extrapolated", e["cpu_seconds"]))
        near = [e for e in entries
                if e["kind"] != "extrapolated" and e["cpu_seconds"] <= 1.25 * entries[0]["cpu_seconds"]]
        best = min(near, key=lambda e: abs(e["error"]), default=None)
        found[bound] = ([best] if best else []) + [e for e in entries if e is not best]
    return found


def _recommendation(definition, summary, rows):
    """One paragraph from the numbers."""
    variable = definition["resolution"]["variable"]
    text, before = [], None
    for bound, entries in summary["reach"].items():
        run = [e for e in entries if e["kind"] != "extrapolated"]
        if not run:
            continue
        best = run[0]
        same = before == (best["method"], best["at"])
        sentence = "the same" if same else f"{best['method']} at {variable} = {best['at']:g}, {_seconds(best['cpu_seconds'])}"
        before = best["method"], best["at"]
        other = max((e for e in entries if e is not best), key=lambda e: e["cpu_seconds"], default=None)
        if other:
            sentence += (f" ({other['method']}: {variable} = {other['at']:.2g}, {_times(other['cpu_seconds'] / best['cpu_seconds'])} the time"
                         + (", extrapolated)" if other["kind"] == "extrapolated" else ")"))
        text.append(f"{bound} %: {sentence}")
    if text:
        text = ["To keep " + "; ".join(text)]
    else:
        curves = [r for r in rows if r["status"] == "ok" and r["role"] == "curve"]
        lowest = min(curves, key=lambda r: abs(r["error"]), default=None)
        text = ["No method kept any of the bounds at its finest runs" +
                (f"; the smallest error was {_percent(lowest['error'])} ({lowest['label']})" if lowest else "")]
    for name, knob in summary["knobs"].items():
        cheap, base, low = knob["cheapest_as_good"], knob["base"], knob["lowest_error"]
        parts = []
        if cheap["cpu_seconds"] < 0.9 * base["cpu_seconds"]:
            parts.append(f"{_word(cheap['value'])} is as accurate as the base for "
                         f"{cheap['cpu_seconds'] / base['cpu_seconds']:.2f} of its time")
        if abs(low["error"]) < 0.67 * abs(base["error"]) and low["value"] != cheap["value"]:
            parts.append(f"the error falls from {_percent(base['error'])} to {_percent(low['error'])} at {_word(low['value'])} for "
                         f"{low['cpu_seconds'] / base['cpu_seconds']:.2f} of the time")
        if knob["optimum"] is not None and (knob["optimum"] not in (low["value"], cheap["value"]) or not parts):
            parts.append(f"the error is least at {_word(knob['optimum'])} and rises to both sides")
        if knob["failed"]:
            flat = knob["flat"]
            parts.append((f"the error is flat from {_word(flat[0])} to {_word(flat[1])}, " if flat else "") + _fails(knob))
        if parts:
            text.append(f"{name[0].upper()}{name[1:]}: {', '.join(parts)}")
    return ". ".join(text) + "."


def _times(ratio):
    return f"{ratio:.1f} times" if ratio < 10.0 else f"{float(f'{ratio:.2g}'):.0f} times"


def _fails(knob):
    """From which value on runs fail, or at which they do."""
    failed, good = knob["failed"], knob["ran"]
    if all(isinstance(v, (int, float)) for v in failed + good) and len(failed) > 1 and min(failed) > max(good):
        return f"runs fail from {min(failed):g} on, the last that runs is {max(good):g}"
    if all(isinstance(v, (int, float)) for v in failed + good) and len(failed) > 1 and max(failed) < min(good):
        return f"runs fail up to {max(failed):g}, the first that runs is {min(good):g}"
    return f"runs fail at {', '.join(map(_word, failed))}"


# ---- pictures ----

def _few_labels(axis):
    """Plain numbers at 1, 2, 5 of a logarithmic axis that spans little, at the decades of one that spans much."""
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


def _resolution_ticks(axes, definition, values):
    """Marks the resolutions that were run, as many as there is room for."""
    sizes = {_size(definition, v): v for v in values}
    room = 0.13 * np.log(max(sizes) / min(sizes)) if sizes else 0.0
    ticks = []
    for size in sorted(sizes):
        if not ticks or np.log(size / ticks[-1]) > room:
            ticks.append(size)
    axes.set_xticks(ticks, [f"{sizes[t]:.3g}" for t in ticks])
    axes.xaxis.set_minor_locator(NullLocator())


def _draw_work(path, definition, rows, curves, methods):
    with plot.picture(path, 10.2, 4.4) as figure:
        panels = figure.subplots(1, 3, sharey=True)
        others = [r for r in rows if r["status"] == "ok" and r["role"] in ("knob", "effect")]
        corners = [r for r in rows if r["status"] == "ok" and r["role"] == "corner"]
        for axes, column in zip(panels, ("size", "cpu_seconds", "particle_steps")):
            get = (lambda r: _size(definition, r["x"])) if column == "size" else lambda r, c=column: r[c]
            if column != "size":
                axes.plot([get(r) for r in others], [100 * abs(r["error"]) for r in others], ".", color="#bbbbbb", markersize=4,
                          label="one setting changed" if column == "cpu_seconds" and others else None, zorder=1)
                axes.plot([get(r) for r in corners], [100 * abs(r["error"]) for r in corners], "D", color="#777777", markersize=4,
                          label="several settings changed" if column == "cpu_seconds" and corners else None, zorder=2)
                front = sorted((r for r in rows if r["front"]), key=get) if column == "cpu_seconds" else []
                if front:
                    axes.plot([get(r) for r in front], [100 * abs(r["error"]) for r in front], "o", markersize=10, color="black",
                              markerfacecolor="none", markeredgewidth=0.9, label="Pareto front", zorder=5)
            for (name, curve), colour in zip(curves.items(), COLOURS):
                if not curve:
                    continue
                x, y = np.array([get(r) for r in curve]), np.array([100 * abs(r["error"]) for r in curve])
                hollow = np.array([r["crossing"] for r in curve])
                label = None
                if column == "size":
                    m = methods[name]
                    label = f"{name} ({_order(m)})" if m["order"] is not None else name
                axes.plot(x, y, "-", color=colour, zorder=3, linewidth=1.3)
                axes.plot(x[~hollow], y[~hollow], "o", color=colour, markersize=4.5, label=label, zorder=4)
                axes.plot(x[hollow], y[hollow], "o", color=colour, markersize=4.5, markerfacecolor="white", zorder=4)
            axes.set(xscale="log", yscale="log")
            if column == "size":
                _resolution_ticks(axes, definition, [r["x"] for curve in curves.values() for r in curve])
            else:
                _few_labels(axes.xaxis)
            _few_labels(axes.yaxis)
        resolution = definition["resolution"]
        panels[0].set_xlabel(resolution["variable"] + (", reversed" if resolution["finer"] == "up" else ""))
        panels[0].set_ylabel(f"{definition['label']} [%]")
        panels[1].set_xlabel("CPU time [s]")
        panels[2].set_xlabel("particle-steps")
        handles = [h for axes in panels[:2] for h in axes.get_legend_handles_labels()[0]]
        labels = [l for axes in panels[:2] for l in axes.get_legend_handles_labels()[1]]
        lines = -(-len(labels) // 3)
        figure.legend(handles, labels, loc="upper center", ncols=3, fontsize=8)
        figure.tight_layout(rect=(0.0, 0.0, 1.0, 1.0 - 0.045 * lines - 0.02))


def _draw_knobs(path, definition, rows):
    knobs = definition["knobs"]
    columns = 3
    lines = -(-len(knobs) // columns)
    with plot.picture(path, 10.2, 2.7 * lines) as figure:
        panels = figure.subplots(lines, columns, squeeze=False)
        for axes in panels.ravel()[len(knobs):]:
            axes.set_visible(False)
        for axes, knob in zip(panels.ravel(), knobs):
            mine = [r for r in rows if r["role"] == "knob" and r["group"] == knob["name"]]
            words = isinstance(knob["values"], dict) or any(isinstance(v, str) for v in knob["values"])
            place = {r["label"]: k if words else float(r["x"]) for k, r in enumerate(mine)}
            good = [r for r in mine if r["status"] == "ok"]
            bad = [r for r in mine if r["status"] == "failed"]
            x = np.array([place[r["label"]] for r in good])
            y = np.array([100 * abs(r["error"]) for r in good])
            time = np.array([r["cpu_seconds"] for r in good])
            right = axes.twinx()
            right.grid(False)
            right.spines["right"].set_visible(True)
            if words:
                right.bar(x, time, width=0.5, color=plot.ORANGE, alpha=0.35)
            else:
                right.plot(x, time, "s-", color=plot.ORANGE, markersize=3, linewidth=1.0)
            right.set_ylim(0.0, 1.15 * max(time, default=1.0))
            axes.plot(x, y, "o" if words else "o-", color=plot.BLUE, markersize=4.5)
            axes.set_zorder(2)
            axes.patch.set_visible(False)
            base = _base(knob, rows)
            if base is not None:
                here = _same(base, good)
                axes.plot([place[r["label"]] for r in here], [100 * abs(r["error"]) for r in here], "o", markersize=10,
                          color="black", markerfacecolor="none", markeredgewidth=0.9)
            axes.set_yscale("log")
            if len(y):
                axes.set_ylim(min(y) / 1.6, max(max(y) * 1.6, min(y) * 8.0))
            _few_labels(axes.yaxis)
            axes.plot([place[r["label"]] for r in bad], [0.94] * len(bad), "x", color=plot.RED, markersize=7, clip_on=False,
                      transform=axes.get_xaxis_transform())
            if words:
                axes.set_xticks(range(len(mine)), [str(r["x"]) for r in mine], rotation=35, ha="right", fontsize=7.5)
                axes.set_xlim(-0.6, len(mine) - 0.4)
            elif place and min(place.values()) > 0.0 and max(place.values()) / min(place.values()) > 15.0:
                axes.set_xscale("log")
                _few_labels(axes.xaxis)
            axes.set_title(f"{knob['name']}\nof {knob['of']}, {definition['resolution']['variable']} = {knob['at']:g}",
                           loc="left", fontsize=8)
            axes.tick_params(axis="y", colors=plot.BLUE, which="both", labelsize=7.5)
            right.tick_params(axis="y", colors=plot.ORANGE, labelsize=7.5)
        height = 2.7 * lines
        figure.subplots_adjust(left=0.07, right=0.93, wspace=0.42, hspace=0.72, top=1.0 - 0.42 / height, bottom=0.72 / height)
        figure.text(0.006, 0.5, f"{definition['label']} [%]", rotation=90, va="center", color=plot.BLUE)
        figure.text(0.984, 0.5, "CPU time [s]", rotation=270, va="center", color=plot.ORANGE)


def _draw_effects(path, definition, rows):
    groups = list(dict.fromkeys(r["group"] for r in rows if r["role"] == "effect"))
    counts = [sum(r["role"] == "effect" and r["group"] == g for r in rows) for g in groups]
    with plot.picture(path, 8.6, 0.34 * sum(counts) + 0.75 * len(groups) + 0.3) as figure:
        panels = figure.subplots(len(groups), 2, squeeze=False, sharey="row", gridspec_kw={"height_ratios": counts})
        for (left, right), group in zip(panels, groups):
            mine = [r for r in rows if r["role"] == "effect" and r["group"] == group][::-1]
            place = np.arange(len(mine))
            colour = [plot.GREY if r["x"] else plot.BLUE for r in mine]
            error = [100 * abs(r["error"]) if r["status"] == "ok" else np.nan for r in mine]
            top = np.nanmax(error) if np.any(np.isfinite(error)) else 1.0
            low = np.nanmin(error) if np.any(np.isfinite(error)) else 0.1
            left.set_xscale("log" if top > 15.0 * low else "linear")
            left.barh(place, error, color=colour, height=0.62)
            right.barh(place, [r["cpu_seconds"] if r["status"] == "ok" else np.nan for r in mine], height=0.62,
                       color=[plot.GREY if r["x"] else plot.ORANGE for r in mine])
            for k, row in enumerate(mine):
                if row["status"] == "ok":
                    left.text(error[k], k, f" {error[k]:.2g}" if error[k] < 99.5 else f" {error[k]:.0f}", va="center", fontsize=7.5)
                    right.text(row["cpu_seconds"], k, f" {row['cpu_seconds']:.2g}", va="center", fontsize=7.5)
                else:
                    left.text(0.01, k, "fails", va="center", fontsize=7.5, color=plot.RED, transform=left.get_yaxis_transform())
            left.set_ylim(-0.6, len(mine) - 0.4)
            left.set_yticks(place, [r["label"] for r in mine])
            left.grid(axis="y", visible=False)
            right.grid(axis="y", visible=False)
            if left.get_xscale() == "log":
                left.set_xlim(0.5 * low, 3.0 * top)
                _few_labels(left.xaxis)
            left.margins(x=0.14)
            right.margins(x=0.14)
            left.set_title(group, loc="left")
        panels[-1][0].set_xlabel(f"{definition['label']} [%]")
        panels[-1][1].set_xlabel("CPU time [s]")
        figure.tight_layout()


# ---- text ----

def _percent(error):
    return f"{100 * error:+.2g} %" if abs(error) < 1.0 else f"{100 * error:+.0f} %"


def _order(method):
    """The order of convergence as text; an interval that holds 0 says that none was seen."""
    if method["order"] is None:
        return "-"
    if abs(method["order"]) < method["order_interval"]:
        return "no order"
    return f"order {method['order']:.2f} ± {method['order_interval']:.2f}"


def _seconds(seconds):
    return f"{seconds:.2g} s" if seconds < 100 else f"{seconds:.0f} s"


def _word(value):
    return f"{value:g}" if isinstance(value, (int, float)) else str(value)


def _bound_cell(entry):
    if entry is None:
        return "-"
    at = f"{entry['at']:g}" if entry["kind"] != "extrapolated" else f"{entry['at']:.2g}"
    text = f"{_seconds(entry['cpu_seconds'])} ({at})"
    return {"coarsest run": f"< {text}", "extrapolated": f"*{text}*"}.get(entry["kind"], text)


def _page(definition, summary, rows, curves):
    variable = definition["resolution"]["variable"]
    lines = [f"# What accuracy costs: {definition['title']}", "",
             f"Made by `{summary['command']}`; all {summary['points']} points are in [points.csv](points.csv). Do not edit: "
             f"it is written anew. Contents of src and potentials: {summary['source']}" +
             (f", as in commit {summary['commit']}." if summary.get("commit") else "."), "",
             f"Error: {definition['label']} (figure `{summary['figure']}`). Reference: {summary['reference']['source']}. "
             f"{definition.get('notes', '')}",
             "Time: CPU seconds of the time loop on one core, " +
             ("one run of each point. " if summary["spread"] is None else "the median of up to three runs, which differ by "
              f"{100 * summary['spread']:.0f} % (median). ") + "Other work on the machine lengthens even CPU time through shared "
             "caches. What does not depend on the machine: particle-steps (of total-Lagrangian solids times sub-steps), pair visits (entries "
             "of the neighbour list times steps, and bonds of total-Lagrangian solids, from both ends, times sub-steps), instructions of "
             "the time loop (callgrind, over the first steps of one run of each method).", "",
             *([f"**Warning**: {moving(summary)}.", ""] if summary["moving"] else []),
             "## In short", summary["recommendation"], "",
             "## Error against resolution, time and work",
             f"![Error against {variable}, CPU time and particle-steps](work.png)", "",
             "Hollow: small because the error changes sign there, which is no accuracy; neither these nor runs with one "
             "setting changed count for the front.", "",
             "| method | order | 10 % | 5 % | 2 % | 1 % | instructions per particle-step | per pair visit |", "|---|---|---|---|---|---|---|---|"]
    for method, found in summary["methods"].items():
        fit = _order(found).removeprefix("order ")
        cells = [_bound_cell(found["bounds"].get(f"{b:g}")) for b in BOUNDS]
        counted = found["instructions"] or {}
        cells += [f"{counted[key]:.0f}" if counted.get(key) else "-" for key in ("per_particle_step", "per_pair_visit")]
        lines.append(f"| {method} | {fit} | " + " | ".join(cells) + " |")
    lines += ["", f"CPU seconds of the coarsest run from which on all finer ones keep the bound, and its {variable}; "
              "`<`: the coarsest one made; *slanted*: extrapolated; -: neither. Order: least squares with 95 % interval, none where that holds 0.", "",
              f"| method | {variable} | value | error | CPU s | spread | particle-steps | pair visits |"
              + "".join(f" {heading} |" for heading in _further(definition).values()), "|---" * (8 + len(_further(definition))) + "|"]
    for method in curves:
        of_method = [r for r in rows if r["role"] == "curve" and r["group"] == method]
        for r in sorted(of_method, key=lambda r: _size(definition, r["x"]), reverse=True):
            if r["status"] == "failed":
                lines.append(f"| {method} | {r['x']:.4g} | fails: {r['why']} |" + " |" * (5 + len(_further(definition))))
                continue
            mark = " (sign changes)" if r["crossing"] else " **front**" if r["front"] else ""
            error = "reference" if r["error"] is None else _percent(r["error"])
            lines.append(f"| {method} | {r['x']:.4g} | {r['value']:.5g} | {error}{mark} | "
                         + f"{r['cpu_seconds']:.3g} | "
                         + (f"{100 * r['spread']:.0f} %" if r["spread"] is not None else "1 run")
                         + f" | {r['particle_steps']:.2e} | " + (f"{r['pair_visits']:.2e} |" if r["pair_visits"] else "- |")
                         + _further_cells(definition, r))
    about = summary["reference"]
    if about["kind"] != "finest" and about["value"]:
        lines.append(f"| reference, {about['kind']} | | {about['value']:.5g} |" + " |" * (5 + len(_further(definition))))
    lines += _particles(definition, rows)
    if summary["knobs"]:
        lines += ["", "## One setting at a time", "![Error and time over each setting](knobs.png)", "",
                  "Blue: error; orange: CPU time; ring: the base; cross: the run fails.", "",
                  "| setting | base | cheapest that is as good | lowest error | all errors | flat over | least between | fails at |",
                  "|---|---|---|---|---|---|---|---|"]
        for knob, k in summary["knobs"].items():
            base, cheap, low = k["base"], k["cheapest_as_good"], k["lowest_error"]
            cells = [f"{_word(r['value'])}: {_percent(r['error'])}, {r['cpu_seconds'] / base['cpu_seconds']:.2f} of the time"
                     for r in (cheap, low)]
            lines.append(f"| {knob} | {_percent(base['error'])}, {_seconds(base['cpu_seconds'])} | {cells[0]} | {cells[1]} | "
                         + " to ".join(f"{100 * e:.2g}" for e in k["error_range"]) + " % | "
                         + (" to ".join(map(_word, k["flat"])) if k["flat"] else "-") + " | "
                         + (_word(k["optimum"]) if k["optimum"] is not None else "-") + " | "
                         + (", ".join(map(_word, k["failed"])) or "-") + " |")
        lines += ["", f"As good: an error of at most {SAME:g} times that of the base. Flat: within that factor of it to both sides. Least "
                  "between: an optimum with errors of one sign that rise on both sides of it."]
        if "also" in definition:
            lines += ["", "| setting | value | error | CPU s |" + "".join(f" {h} |" for h in _further(definition).values()),
                      "|---" * (4 + len(_further(definition))) + "|"]
            lines += [f"| {r['group']} | {_word(r['x'])} | "
                      + (f"{_percent(r['error'])} | {r['cpu_seconds']:.3g} |" if r["status"] == "ok" else "fails | |")
                      + _further_cells(definition, r) for r in rows if r["role"] == "knob"]
    if any(row["role"] == "effect" for row in rows):
        lines += ["", "## What each effect is worth", "![Error and time with and without](effects.png)", "",
                  "Grey: the base; the others differ from it as said."]
    corners = [r for r in rows if r["role"] == "corner"]
    if corners:
        lines += ["", "## Several settings at once", "| settings | error | CPU s | particle-steps |", "|---|---|---|---|"]
        for r in corners:
            mark = " **front**" if r["front"] else ""
            cells = f"{_percent(r['error'])}{mark} | {r['cpu_seconds']:.3g} | {r['particle_steps']:.2e}" if r["status"] == "ok" else "fails | |"
            lines.append(f"| {r['label']} | {cells} |")
    return "\n".join(lines) + "\n"


def _particles(definition, rows):
    """The table of what each resolution is made of."""
    runs = {r["x"]: r["point"]["bodies"] for r in rows if r["role"] == "curve" and r["point"].get("bodies")}
    if not runs:
        return []
    sizes = sorted(runs, key=lambda x: _size(definition, x), reverse=True)
    cell = lambda count, size: f"{count:,}" + (": " + " x ".join(f"{s:.3g}" for s in size) if size else "")
    names = list(dict.fromkeys(name for bodies in runs.values() for name, *_ in bodies))
    lines = ["", f"Particles of each body (fluids and walls: of each type) at each {definition['resolution']['variable']}, and their extent in spacings, the least first:", "",
             "| | " + " | ".join(f"{x:.4g}" for x in sizes) + " |", "|---" * (1 + len(sizes)) + "|"]
    for name in names[:MANY]:
        found = [next((cell(*rest) for body, *rest in runs[x] if body == name), "-") for x in sizes]
        lines.append(f"| {name} | " + " | ".join(found) + " |")
    return lines + ([f"| and {len(names) - MANY} more |" + " |" * len(sizes)] if len(names) > MANY else [])


def _index():
    """doc/cost/README.md from the summaries beside it."""
    lines = ["# What accuracy costs", "",
             "How many seconds a given error costs, method by method and setting by setting, from sweeps of the bundled scenes: "
             "[how to choose](../choosing.md), [how these are made](../choosing.md#the-sweep-of-a-scene). Written by `tools/cost`. "
             "What each effect adds to a step: [effects](effects.md); beside LAMMPS' own styles: [peers](peers.md); many ranks: [scaling](scaling.md).", "",
             "| scene | error of, against | 10 % | 5 % | 2 % | 1 % |", "|---|---|---|---|---|---|"]
    found = [json.loads(path.read_text()) for path in sorted(PAGE.glob("*.json"))]
    for summary in found:
        cells = []
        for bound in BOUNDS:
            run = [e for e in summary["reach"][f"{bound:g}"] if e["kind"] != "extrapolated"]
            cells.append(f"{_bound_cell(run[0])} {run[0]['method']}" if run else "-")
        lines.append(f"| [{summary['title']}]({summary['scene']}.md) | `{summary['figure']}`; {summary['reference']['source']} | "
                     + " | ".join(cells) + " |")
    lines += ["", "CPU seconds (in brackets the resolution) of the cheapest method whose runs keep the bound from there on.", ""]
    for summary in found:
        picture = f"![Error against resolution, time and work]({summary['scene']}_work.png)"
        lines += [f"## {summary['title']}", f"[{picture}]({summary['scene']}.md)", "", summary["recommendation"], ""]
    return "\n".join(lines)
