"""What accuracy costs: the command line of tools/cost. A scene's sweep is its cost.json."""

import contextlib
import json
from pathlib import Path

import cost_report
import numpy as np
from tool import figures_of, left, say

from fsi import log, paths, scene, series, sweep
from fsi.command import Refusal, number, split, start

OPTIONS = ("out", "budget", "limit", "repeats", "draw", "source")
BASE_CFL = 0.25


def load(name, given):
    """The definition in a scene's cost.json, `given` in all its runs."""
    path = paths.EXAMPLES / name / "cost.json"
    if not path.exists():
        known = [folder.parent.name for folder in sorted(paths.EXAMPLES.glob("*/cost.json"))]
        raise Refusal(f"there is no {path.name} of a scene '{name}'. Scenes that have one: "
                      f"{', '.join(known)}")
    try:
        definition = json.loads(path.read_text())
    except ValueError as error:
        raise Refusal(f"{path}: {error}") from None
    definition["command"] = "tools/cost " + " ".join(
        [name, *(f"{k}={v}" for k, v in given.items())])
    definition["common"] = {**definition.get("common", {}), **given}
    return definition


def points(definition):
    """Every run that a definition asks for: [{"role", "group", "label", "x", "settings"}], a run
    may have several roles.

    Roles: curve (x: value of the resolution), knob (x: value), effect (x: whether it is the base),
    corner.
    """
    common, variable = definition["common"], definition["resolution"]["variable"]
    found = []

    def add(role, group, label, x, *settings):
        merged = dict(common)
        for part in settings:
            merged |= part
        found.append({"role": role, "group": group, "label": label, "x": x, "settings": merged})

    def base(entry):
        if entry["of"] not in definition["methods"]:
            raise Refusal(f"cost.json: '{entry['of']}' is none of the methods")
        return {**definition["methods"][entry["of"]]["settings"], variable: entry["at"]}

    for name, method in definition["methods"].items():
        for value in method["at"]:
            add("curve", name, f"{name}, {variable} = {value:g}", value, method["settings"],
                {variable: value})
    for knob in definition.get("knobs", ()):
        values = knob["values"]
        choices = values.items() if isinstance(values, dict) else ((v, {knob["variable"]: v})
                                                                   for v in values)
        for label, change in choices:
            add("knob", knob["name"], f"{knob['name']} = {label}", label, base(knob), change)
    for effect in definition.get("effects", ()):
        group = f"{effect['of']}, {variable} = {effect['at']}"
        add("effect", group, "base", True, base(effect))
        for label, change in effect["cases"].items():
            add("effect", group, label, False, base(effect), change)
    for label, settings in definition.get("corners", {}).items():
        add("corner", "", label, None, settings)
    return found


def representatives(definition, store):
    """[(label, settings)]: of each method the middle one of the resolutions that ran, where its
    instructions are counted."""
    found = []
    for name in definition["methods"]:
        curve = [p for p in points(definition) if p["role"] == "curve" and p["group"] == name]
        ran = [p for p in curve if (run := store.get(p["settings"])) and run["status"] == "ok"]
        found += [(p["label"], p["settings"]) for p in ran[len(ran) // 2:][:1]]
    return found


def work(definition, settings):
    """What a run should cost, in any unit, from its resolution and time step: for the order of runs
    and the time left."""
    value = float(settings[definition["resolution"]["variable"]])
    fineness = value if definition["resolution"]["finer"] == "up" else 1.0 / value
    sound = float(settings.get("c", settings.get("sound", 10)))
    return fineness**(definition.get("dimension", 2) + 1) * sound / 10.0 / float(
        settings.get("cfl", BASE_CFL))


def analysed(name):
    """What turns the folder of a scene's run into its figures: the scene's own analysis."""
    module = scene.analysis(name)

    def measure(folder):
        module.main(folder)
        return figures_of(folder)
    return measure


def printed(name):
    """The same for a deck of its own: what it prints as FSI NAME value, or the end of a thermo
    column; and whether that still moves."""
    def measure(folder):
        found = log.read(folder / "log.lammps")
        if name in found.values:
            value = float(found.values[name])
        else:
            column = found.column(name, f"v_{name}")
            if column is None:
                raise ValueError(f"the log has neither a line 'FSI {name} value' nor a thermo "
                                 f"column {name} or v_{name}")
            value = float(column[-1])
        return {name: value, cost_report.MOVING: still_moving(folder, found, name, value)}
    return measure


def still_moving(folder, found, name, value):
    """series.still_moving() of the column that a figure is of: its own, or else the one whose end
    or extreme it is; None where there is none."""
    tables = [{key: found.column(key)
               for key in dict.fromkeys(key for run in found.runs for key in run.thermo)}]
    for path in sorted(folder.glob("*.csv")):
        with contextlib.suppress(ValueError):  # another kind of table
            tables.append(series.read(path).columns)
    for own in (True, False):
        for table in tables:
            time = next((table[key] for key in ("v_time", "Time", "time", "v_t", "t", "Step")
                         if key in table), None)
            for key, column in table.items():
                if time is None or column is time or len(column) != len(time) or len(column) < 3:
                    continue
                ends = (column[-1], column.max(), column.min(), np.abs(column).max(),
                        np.ptp(column))
                if key in (name, f"v_{name}") if own else np.isclose(
                    value, ends, rtol=1e-3, atol=0.0).any() and np.ptp(column):
                    return series.still_moving(time, column)
    return None


def own_deck(path, vary, measure, given):
    """The definition of a sweep of somebody's own deck."""
    (variable, values), *others = vary.items()
    try:
        values = [float(v) for v in values]
    except ValueError:
        raise Refusal(
            f"--vary {variable}: the first one is the resolution and must be numbers") from None
    whole = all(v == int(v) and v >= 1.0 for v in values)  # a number of particles; else a spacing
    values = [int(v) for v in values] if whole else values
    values.sort(reverse=not whole)
    first = {name: choices[0] for name, choices in others}
    methods = {", ".join(f"{n} {v}" for n, v in first.items()) or "deck": first}
    for name, choices in others:
        for choice in choices[1:]:
            methods[f"{name} {choice}"] = {**first, name: choice}
    words = "".join(f" --vary {n}={','.join(map(str, v))}" for n, v in vary.items())
    return {
        "title": path.name, "figure": measure, "label": f"error of {measure}",
        "reference": None,
        "resolution": {"variable": variable, "finer": "up" if whole else "down", "text": variable},
        "common": given, "methods": {n: {"settings": s, "at": values} for n, s in methods.items()},
        "command": f"tools/cost {path.name}{words} --measure {measure}"
        + "".join(f" {k}={v}" for k, v in given.items())}


def name_of(deck):
    """Its name without what says that it is a deck: in.flap and flap.in are flap."""
    return deck.name.removeprefix("in.") if deck.name.startswith("in.") else deck.stem


def parse(arguments):
    """(scene or deck, options, settings, {varied name: [values]}, measure)."""
    what, assigned, vary, measure = arguments[0], [], {}, None
    rest = iter(arguments[1:])
    for argument in rest:
        if argument in ("--vary", "--measure"):
            value = next(rest, None)
            if value is None:
                raise Refusal(f"{argument} needs a value")
            if argument == "--measure":
                measure = value
                continue
            name, equals, values = value.partition("=")
            if not equals or not all(values.split(",")):
                raise Refusal(f"--vary {value}: expected NAME=V1,V2,...")
            vary[name] = values.split(",")
        else:
            assigned.append(argument)
    options, settings = split(assigned, OPTIONS)
    for name in ("budget", "limit", "repeats"):
        options[name] = number(name, options[name], int if name == "repeats"
                               else float) if name in options else None
    return what, options, settings, vary, measure


def main(arguments):
    what, options, given, vary, measure = parse(arguments)
    bundled = what in scene.scenes()
    if bundled and (vary or measure):
        raise Refusal("--vary and --measure are for a deck of your own; a scene's sweep is in its "
                      "cost.json")
    if bundled:
        definition, deck_path, name = load(what, given), scene.deck(what), what
        measure, files = analysed(what), ()
    else:
        deck_path = Path(what)
        if not deck_path.is_file():
            raise Refusal(f"'{what}' is neither a scene nor a file")
        if not vary or not measure:
            raise Refusal("a deck of your own needs --vary NAME=V1,V2,V3 (the resolution first) "
                          "and --measure NAME")
        definition = own_deck(deck_path, vary, measure, given)
        name, measure = name_of(deck_path), printed(measure)
        beside = deck_path.resolve().parent.iterdir()
        files = [p for p in beside if p.is_file() and p.name not in ("log.lammps", deck_path.name)]
    folder = Path(options["out"]).resolve() if "out" in options else paths.RESULTS / "cost" / name
    if "source" in options and "draw" not in options:
        raise Refusal("source= is for draw=only: what runs is what is built")
    deck = sweep.Deck(deck_path, definition.get("edits"))
    wanted = points(definition)
    for point in wanted:
        deck.instance(point["settings"])  # refuses names that do not exist before the first run
    if options.get("draw") is None and not scene.build():
        return 1

    store = sweep.Store(folder / "points", deck, measure, files, options["limit"] or 600.0,
                        options["repeats"], options.get("source"))
    if options.get("draw") is None:
        for settings in (point["settings"] for point in wanted if bundled):
            if there := left(deck, name, settings):  # what tools/run left is not run again
                store.take(settings, there, figures_of(there))
        complete = sweep.sweep(store, [(p["label"], p["settings"], work(definition, p["settings"]))
                                       for p in wanted],
                               say, options["budget"])
        if complete:
            sweep.count(store, representatives(definition, store), say)
    for point in wanted:
        point["run"] = store.get(point["settings"])
    summary = cost_report.write(folder, name, definition, [p for p in wanted if p["run"]],
                                store.source)
    if summary["moving"]:
        say(f"cost: warning: {cost_report.moving(summary)}")
    print(f"cost: page, picture and table are in {folder}")
    return 0


if __name__ == "__main__":
    start("cost", main)
