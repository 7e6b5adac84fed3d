#!/usr/bin/env python3
"""Hard cases: what each must keep, and what was measured.   usage: analyze.py FOLDER

main(folder) measures one run of cases.json, called GROUP.RECIPE: one of RECIPES, or `preset`, a
preset without what `best` adds to it. study(folder, cases) makes the table of ROWS from them; a row
that `best` misses is an error.
"""

import csv
import json
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, scene, series, sweep  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import RUN_FILE, Summary, number  # noqa: E402

CAUSES = (r"Fix fsi(?:/watch|/dt)?: .*(Mach number|distance over|density error|density \S+ is not "
          r"above 0|the time step \S+ is above|kinetic energy|not finite)")
LINK = 1.5  # [dx] farther apart, two particles do not hang together


# ---- measures: {figure: value} of a run's folder -------------------------------------------------

def frames_of(folder):
    return dump.read(Path(folder) / "particles.dump")


def values_of(folder):
    return log.read(Path(folder) / "log.lammps").values


def near(x, reach, y=None):
    """(i, j) of all ordered pairs i != j of points of x (of a point of x and one of y) within
    `reach`, and their distances."""
    other = x if y is None else y
    order = np.argsort(other[:, 0])
    first, last = (np.searchsorted(other[order, 0], x[:, 0] + side * reach) for side in (-1, 1))
    i = np.repeat(np.arange(len(x)), last - first)
    j = order[np.arange(len(i)) + np.repeat(first
                                            - np.concatenate([[0], np.cumsum(last - first)[:-1]]),
                                            last - first)]
    apart = np.hypot(*(x[i] - other[j]).T)
    kept = (apart < reach) & ((i != j) | (y is not None))
    return i[kept], j[kept], apart[kept]


def pieces(x, reach):
    """Sizes of the clusters of points that are linked by distances below `reach`, the largest
    first."""
    i, j, _ = near(x, reach)
    label = np.arange(len(x))
    while True:
        lowest = label.copy()
        np.minimum.at(lowest, i, label[j])
        lowest = lowest[lowest]
        if (lowest == label).all():
            return sorted(np.unique(label, return_counts=True)[1].tolist(), reverse=True)
        label = lowest


def solid(folder, reach=LINK):
    """The worst particle's share of its first neighbours (along the lattice) that are still within
    `reach` dx; nearest pair."""
    frames, dx = frames_of(folder), values_of(folder)["dx"]
    first = frames[0].vector("xy")
    i, j, _ = near(first, 1.1 * dx)
    had = np.bincount(i, minlength=len(first))
    kept, smallest = 1.0, np.inf
    for frame in frames[1:]:
        if len(frame) < len(first):
            return {"neighbours_kept": 0.0, "distance": smallest}
        x = frame.vector("xy")
        have = np.bincount(i, np.hypot(*(x[i] - x[j]).T) < reach * dx, len(first))
        kept = min(kept, float((have[had > 0] / had[had > 0]).min()))
        smallest = min(smallest, min_pair_distance(x, dx) / dx)
    return {"neighbours_kept": kept, "distance": smallest}


def plate(folder):
    """As solid; and how many periods of the thin plate the run is short of its length."""
    values = values_of(folder)
    return {"periods_missed": round(max(0.0, values["tend"] - values.get("end", 0.0)) / 0.2541, 1),
            **solid(folder)}


def liquid(folder):
    """Share of the water in one piece, nearest pair, both the worst of all pictures."""
    frames, dx = frames_of(folder), values_of(folder)["dx"]
    whole = min(pieces(f.vector("xy"), LINK * dx)[0] / len(frames[0])
                for f in frames[:: max(1, len(frames) // 10)] + frames[-1:])
    return {"in_one_piece": whole,
            "distance": min(min_pair_distance(f.vector("xy"), dx) for f in frames) / dx}


def scene_figures(folder, name):
    """The figures that a scene's own analysis makes of the run, without its pictures: {name:
    figure}."""
    with sweep.quiet():
        return {f["name"]: f for f in scene.analysis(name).main(folder)["figures"]}


def gate(folder):
    found = scene_figures(folder, "gate_static")
    return {"deflection_error": abs(found["tip_x"]["value"] / 34.81 - 1.0)}


def locking(folder):
    """Tip of a cantilever under its weight over that of finite elements (Q2/P1, plane strain,
    length 6 H: unittest/elements.py)."""
    given = json.loads((Path(folder) / RUN_FILE).read_text())["variables"]
    exact = {"0.49": 1.1505, "0.499": 1.1353}[given["nu"]] * 1000 * 2 * 0.24**4 / (2e6 * 0.04**2)
    first, last = frames_of(folder)[0], frames_of(folder)[-1]
    x, sunk = first["x"], first["y"] - last["y"]
    column = np.round((x - x.max()) / values_of(folder)["dx"])
    tip = 1.5 * sunk[column == 0].mean() - 0.5 * sunk[column == -1].mean()
    return {"deflection_error": abs(tip / exact - 1.0)}


def breaking(folder):
    return {"leaked": scene_figures(folder, "elastic_gate")["particles_leaked"]["value"]}


def drift(folder):
    """Of the deflection, by a line through it, from 0.5 s to 2 s, over its mean."""
    table = series.read(Path(folder) / "plate.csv")
    late = table.time >= 0.5
    time, w = table.time[late], table["deflection"][late]
    return {"drift": abs(np.polyfit(time, w, 1)[0] * 1.5 / w.mean()) if table.time[-1] > 1.99
            else np.nan}


def floating(folder):
    found = scene_figures(folder, "floating_blocks")
    place = found.get("draft_error") or found["gap_to_floor"]
    return {"draft_error": abs(place["value"]), "leaked": found["particles_leaked"]["value"]}


def still(folder):
    """Water: the worst pressure and kinetic energy of the second half of the run, the nearest pair
    of all of it but the start.

    Under a lid, in a closed box, pressure is known but for a constant: its mean is taken out.
    """
    folder, dx = Path(folder), values_of(folder)["dx"]
    frames = [f.of_types(1) for f in frames_of(folder)]
    found = {"pressure_error": 0.0, "ke_over_pe": 0.0}
    for frame in frames[len(frames) // 2:]:
        exact = 1000.0 * 9.81 * np.maximum(0.5 - frame["y"], 0.0)
        off = frame["p"] - exact
        if "lid" in folder.name:
            off = off - off.mean()
        ke = 0.5 * (frame["vx"] ** 2 + frame["vy"] ** 2).sum()
        for name, value in (("pressure_error", np.linalg.norm(off) / np.linalg.norm(exact)),
                            ("ke_over_pe", ke / (9.81 * frame["y"]).sum())):
            found[name] = max(found[name], float(value))
    return {**found, "distance": min(min_pair_distance(f.vector("xy"), dx) for f in frames[1:])
            / dx}


def impact(folder):
    """Largest speed over c and density error of the water, in all lines of series.csv."""
    table, c = series.read(Path(folder) / "series.csv"), values_of(folder)["c"]
    return {"mach": table["speed"].max() / c, "density_error": table["density_error"].max()}


def jet(folder):
    """As impact; and what the water's momentum and the impulse on the plate together differ from
    what the water brought."""
    table = series.read(Path(folder) / "series.csv")
    frames = frames_of(folder)
    px = [(f["mass"] * f["vx"])[f["type"] == 1].sum() for f in frames]
    impulse = np.concatenate([[0.0], np.cumsum(np.diff(table.time) * table["fx"][1:])])
    balance = np.abs(table["px"] + impulse - px[0]) / px[0]
    return {**impact(folder), "impulse_error": balance.max()}


def splash(folder):
    """Change of the energy ledger's sum over the kinetic energy at the start, smallest density over
    that at rest, particles lost."""
    table, energy = (series.read(Path(folder) / name) for name in ("series.csv", "energy.csv"))
    return {"energy_error": np.abs(energy["energy"] - energy["energy"][0]).max()
            / energy["kinetic"][0],
            "smallest_density": table["density"].min() / 1000.0,
            "lost": int(table["atoms"][0] - table["atoms"].min())}


def hairpin(folder):
    """The smallest distance of the arms, by all pictures; change of the energy ledger's sum over
    the kinetic energy at the start."""
    frames, dx = frames_of(folder), values_of(folder)["dx"]
    x, y = frames[0]["x"], frames[0]["y"]
    low, up = ((x > 4 * dx) & side for side in (y < 4 * dx, y > 16 * dx))
    nearest = 20.0
    for frame in frames:
        place = frame.vector("xy")
        apart = near(place[low], nearest * dx, place[up])[2]
        nearest = min(nearest, apart.min() / dx if len(apart) else nearest)
    energy = series.read(Path(folder) / "energy.csv")
    return {"gap": nearest, "energy_error": np.abs(energy["energy"] - energy["energy"][0]).max()
            / energy["kinetic"][0]}


def settled(folder):
    """Volume of the water at rest over that of the start, less one: by the height of its middle,
    mean of the last tenth of the run."""
    table = series.read(Path(folder) / "series.csv")
    late = table.time > 0.9 * table.time[-1]
    return {"volume_error": abs(2.0 * table["mean"][late].mean() / values_of(folder)["rest"] - 1.0)}


def ballistic(folder):
    """Largest distance from the parabola of a particle without air, over the way that it made."""
    frames = frames_of(folder)
    x0, v0 = frames[0].vector("xy"), np.array([1.0, 2.0])
    worst = 0.0
    for f in frames[1:]:
        t = f.time
        exact = x0 + v0 * t - np.array([0.0, 0.5 * 9.81 * t * t])
        worst = max(worst, np.abs(f.vector("xy") - exact).max() / t)
    return {"off_parabola": worst}


def wall(folder):
    table = series.read(Path(folder) / "series.csv")
    frames, dx = frames_of(folder), values_of(folder)["dx"]
    leaks = Leaks(0.0)
    for f in frames:
        leaks.see(f)
        leaks.beyond_walls(f, [("x", 0.0, -1), ("x", 3 * dx, 1), ("y", 0.0, -1)])
    return {"leaked": leaks.count(log.read(Path(folder) / "log.lammps"))
            + int((table["low"] <= 0.0).sum()),
            "steps": frames[-1].step}


def valve(folder):
    """Largest number of water particles in a picture that are inside a leaflet: nearer than its
    spacing to one of its particles, less a fifth."""
    frames, dx = frames_of(folder), values_of(folder)["dx"]
    inside = [
        len(np.unique(near(f.of_types(1).vector("xy"), 0.2 * dx, f.vector("xy")[f["type"] > 1])[0]))
        for f in frames]
    return {"inside": max(inside)}


def pull(folder):
    """Water within a support of the plate at the end; the largest pull on it once its underside is
    above the water's level (0.04 s)."""
    frame, values = frames_of(folder)[-1], values_of(folder)
    water, plate_ = frame.of_types(1).vector("xy"), frame.of_types(2).vector("xy")
    hanging = np.unique(near(water, 2.0 * values["h"], plate_)[0])
    table = series.read(Path(folder) / "series.csv")
    return {"hanging": len(hanging), "pull": max(0.0, -table["fy"][table.time > 0.04].min())}


def tear(folder):
    """Pieces of ten particles or more at the end; where there is a run on 1 rank, the largest
    distance to its particles."""
    folder = Path(folder)
    frames, dx = frames_of(folder), values_of(folder)["dx"]
    found = {"pieces": sum(size >= 10 for size in pieces(frames[-1].vector("xy"), LINK * dx))}
    serial = folder.parent / "tear_serial.best"
    if folder.name == "tear.best" and (serial / "particles.dump").exists():
        # who is who: by the place in the lattice, since ids depend on the ranks
        ends = []
        for run in (frames, frames_of(serial)):
            first = run[0].vector("xy").round(9)
            ends.append(run[-1].vector("xy")[np.lexsort(first.T)])
        found["ranks_differ"] = float(np.abs(ends[0] - ends[1]).max() / dx)
    return found


def momentum(folder):
    """Largest change of the momentum of all particles over its size."""
    sums = [[(f["mass"] * f[v]).sum() for v in ("vx", "vy")] for f in frames_of(folder)]
    return {"momentum_error": float(np.abs(np.subtract(sums, sums[0])).max() / np.hypot(*sums[0]))}


def between_ends(folder):
    """Mass between open ends over what its density has room for, against the start; the worst mean
    of a tenth of the run."""
    table = series.read(Path(folder) / "series.csv")
    fill = table["number"] / table["number"][0] * table["density"][0] / table["density"]
    return {"mass_error": float(max(abs(part.mean() - 1) for part in np.array_split(fill, 10)))}


def honest(folder):
    """1 for a run that is sound, judged by the free end of that with the shortest step, or that
    stopped and told why, without a NaN."""
    folder = Path(folder)
    errors = log.read(folder / "log.lammps").errors
    finite = all(np.isfinite(f.vector(("x", "y", "vx", "vy", "rho"))).all()
                 for f in frames_of(folder))
    if errors:
        return {"honest": int(finite and bool(re.search(CAUSES, errors[0])))}
    first = folder.parent / re.sub(r"_\d+\.", "_1.", folder.name) / "tip.csv"
    tip = [series.read(path)["tip_x"][-1] for path in (folder / "tip.csv", first)]
    return {"honest": int(finite and abs(tip[0] / tip[1] - 1.0) < 0.1)}


# ---- the table -----------------------------------------------------------------------------------

@dataclass
class Row:
    """Groups of runs that are judged together, the worst figure of all: bounds {figure: (relation,
    bound)}."""

    title: str
    groups: str  # regular expression
    measure: Callable
    bounds: dict
    # of the best recipe: a preset and what it needs beside it; none of a test of software
    scheme: str = ""
    alone: str = ""  # the preset that is also run without that
    stops: bool = False  # whether a run that is stopped can be right


BODY = {"neighbours_kept": (">=", 0.6), "distance": (">", 0.5)}
WATER = {"in_one_piece": (">=", 0.99), "distance": (">", 0.5)}
STILL = {"pressure_error": ("<", 0.03), "ke_over_pe": ("<", 1e-5), "distance": (">=", 0.6)}
RECIPES = {"best": "here", "delta": "delta-SPH", "classic": "classic SPH"}
ROWS = {
    "rings_slow": Row("rubber rings at 0.06 c0", r"rings_0\.06", solid, BODY,
                      "solid/tl, contact 2.5"),
    "rings_fast": Row("rubber rings at 0.1 c0", r"rings_0\.1", solid, BODY,
                      "solid/tl, contact 2.5"),
    "drop": Row("stretched drop of water", "drop", liquid, WATER, "closed"),
    "patch": Row("spinning patch of water: to omega t = 2", "patch", liquid, WATER, "closed"),
    "spin": Row("spinning plate: 5 turns", "spin", solid, BODY, "solid/tl"),
    "plate": Row("oscillating plate: 5 particles thick, 300 periods", "plate", plate,
                 {"periods_missed": ("<=", 0), **BODY}, "solid/tl"),
    "gates": Row("gate under a static load: 3, 4, 5, 8 particles thick", r"gate_\d", gate,
                 {"deflection_error": ("<=", 0.08)}, "solid/tl, artificial/visc 0.1"),
    "locking": Row("nearly incompressible cantilever: 4 particles thick, Poisson's ratio 0.49 and "
                   "0.499", r"lock_.*", locking,
                   {"deflection_error": ("<=", 0.03)}, "solid/tl, artificial/visc 0.1"),
    "break": Row("dam break on a gate: 3, 4, 5, 8 particles thick, up to 0.2, 0.08, 0.05, 0.02 s",
                 r"break_\d", breaking, {"leaked": ("<=", 0)}, "splash"),
    "density_gate": Row("light and heavy gate: 0.1 and 10 times the density of water",
                        "break_density_.*", breaking, {"leaked": ("<=", 0)}, "splash"),
    "sound": Row("soft to stiff plate under water: speed of sound 5, 20, 100 times the fluid's",
                 "sound_.*", drift, {"drift": ("<", 0.02)}, "splash"),
    "float": Row("floating and sunken blocks: density ratio 0.1, 0.5, 0.9, 2, 10", "float_.*",
                 floating, {"draft_error": ("<=", 0.5), "leaked": ("<=", 0)},
                 "splash, artificial/visc 0.05", "splash"),
    "obstacle": Row("dam break on an elastic obstacle", "obstacle", impact,
                    {"mach": ("<", 0.3), "density_error": ("<", 0.05)},
                    "splash, tension yes, shift 0.1", "splash"),
    "valve": Row("valve of two thin leaflets: tips in the water", "valve", valve,
                 {"inside": ("<=", 0)}, "stream, thin"),
    "jet": Row("jet on a plate", "jet", jet,
               {"mach": ("<", 0.3), "density_error": ("<", 0.05), "impulse_error": ("<", 0.01)},
               "splash, tension yes, shift 0.1", "splash"),
    "still": Row("still water: 10 s, 10, 15, 20 rows, and under a lid", r"still_(\d+|lid)", still,
                 STILL, "splash, artificial/visc 0.05", "waves"),
    "still_jitter": Row("still water from a jittered lattice: 10 s, 10, 15, 20 rows",
                        r"still_\d+_jitter", still, STILL, "splash, artificial/visc 0.05", "waves"),
    "corner": Row("still water around corners: 10 s, 10 and 20 rows", r"still_corner_\d+", still,
                  STILL, "splash", "waves"),
    "spray": Row("spray: 1, 2, 3 particles", "spray_.*", ballistic, {"off_parabola": ("<", 1e-12)},
                 "splash"),
    "splash": Row("falling cube of water: at 1, 2, 3, 5 m/s onto a floor, until at rest (3D)",
                  r"splash_.*", splash,
                  {"energy_error": ("<", 0.01), "smallest_density": (">", 0.1), "lost": ("<=", 0)},
                  "splash"),
    "settle": Row("volume at rest: after a dam break, and after a fall into a box (3D)",
                  r"settle_.*", settled, {"volume_error": ("<", 0.01)},
                  "splash, density/surface yes", "splash"),
    "wall": Row("a million steps on a floor: a particle, and a drop of nine", "wall.*", wall,
                {"leaked": ("<=", 0), "steps": (">=", 1000000)},
                "splash, guard 0.4", "splash"),
    "pull": Row("plate pulled out of water", "pull", pull,
                {"hanging": ("<=", 0), "pull": ("<", 1e-12)}, "splash"),
    "hairpin": Row("hairpin whose arms clap together", "hairpin", hairpin,
                   {"gap": (">", 1.5), "energy_error": ("<", 0.01)},
                   "solid/tl, artificial/visc 0.1, contact 2 self yes"),
    "ends": Row("open ends: pressure that swings, flow that reverses", "ends_.*", between_ends,
                {"mass_error": ("<", 0.01)},
                "stream, Wendland h = 1.5 dx, shift 0.1", "stream"),
    "fill": Row("open ends with shifting 0.5", "fill", between_ends, {"mass_error": ("<", 0.01)}),
    "tear": Row("solid torn between two ranks", "tear.*", tear,
                {"pieces": ("==", 2), "ranks_differ": ("<", 1e-6)}),
    "empty": Row("box that empties on a rank", "empty", momentum, {"momentum_error": ("<", 1e-12)}),
    "jump_water": Row("sudden steps, 10 times longer and shorter: still water", "jump_water", still,
                      STILL),
    "jump_plate": Row("sudden steps: spinning plate", "jump_plate", solid, BODY),
    "dt": Row("gate, 1 to 6 times the stable step, Courant check on and off", r"dt_(off_)?\d",
              honest, {"honest": ("==", 1)}, stops=True),
}
RELATIONS = {"<": np.less, "<=": np.less_equal, ">": np.greater, ">=": np.greater_equal,
             "==": np.equal}
LABELS = {"distance": ("nearest pair", "dx"), "gap": ("least gap", "dx"), "neighbours_kept":
              ("first neighbors kept", "%"), "in_one_piece": ("water in one piece", "%"),
          "ke_over_pe": ("kinetic / potential energy", ""), "pull": ("pull", "N/m"),
          "draft_error": ("draft or gap off by", "dx"), "mach": ("speed", "c"),
          "honest": ("sound, or stopped by the right cause", ""),
          "off_parabola": ("off the parabola by", "m/s"),
          "ranks_differ": ("difference from one rank", "dx"),
          "smallest_density": ("smallest density", "of that at rest"),
          "hanging": ("particles that hang on", ""), "inside": ("particles inside", ""),
          "leaked": ("particles leaked", ""), "lost": ("particles lost", ""),
          "drift": ("drift", "%"), "momentum_error": ("momentum error", ""),
          **{f"{what}_error": (f"{what} error", "%") for what in ("deflection", "density",
                                                                  "impulse", "pressure", "energy",
                                                                  "volume", "mass")}}


def label(figure):
    return LABELS.get(figure, (figure.replace("_", " "), ""))[0]


def quantity(figure, value, unit=None):
    """A value of a figure with its unit, or with another word behind it."""
    own = LABELS.get(figure, ("", ""))[1]
    value = 100 * value if own == "%" else value
    text = number(value) if isinstance(value, int) or abs(value) >= 1e4 else f"{value:.3g}"
    return f"{text} {own if unit is None else unit}".rstrip()


def bound_text(figure, relation, bound):
    """The bound as text, such as: nearest pair > 0.5 dx."""
    return f"{label(figure)} {relation} {quantity(figure, bound)}"


def row_of(group):
    return next((row for row in ROWS.values() if re.fullmatch(row.groups, group)), None)


def cause(folder):
    """Why LAMMPS ended the run, in its own words; None if it did not."""
    found = log.read(Path(folder) / "log.lammps")
    status = json.loads((Path(folder) / RUN_FILE).read_text()).get("status", 0) if (
        Path(folder) / RUN_FILE).exists() else 0
    if not found.errors:
        return f"exit status {status}" if status else None
    text = re.sub(r"^ERROR(?: on proc \d+)?: ", "", found.errors[0])
    return re.sub(r"\. (Try|State|Particles).*| \(src/.*", "", text)


def main(folder):
    """Measures the run in `folder`; returns the summary."""
    folder = Path(folder)
    run = json.loads((folder / RUN_FILE).read_text())
    row = row_of((run.get("case") or "").rpartition(".")[0])
    stopped = cause(folder)
    found = row.measure(folder) if row and (not stopped or row.stops) else {}
    summary = Summary(folder)
    for figure, value in found.items():
        summary.add(figure, value)
    if stopped:
        summary.add("stopped", stopped)
    return summary.write()


def passes(value, relation, bound):
    return value is not None and bool(RELATIONS[relation](value, bound))


def collect(summaries):
    """The table: a dictionary per row, from the summaries of its runs {GROUP.RECIPE: summary}."""
    table = []
    for name, row in ROWS.items():
        entry = {"row": name, "case": row.title, "scheme": row.scheme, "alone": row.alone,
                 "bounds": {f: bound_text(f, *bound) for f, bound in row.bounds.items()},
                 "recipes": {}}
        for case, summary in summaries.items():
            group, _, recipe = case.rpartition(".")
            if not re.fullmatch(row.groups, group):
                continue
            figures = {f["name"]: f["value"] for f in summary["figures"]}
            stopped = figures.get("stopped")
            judged = {f: figures.get(f) for f in row.bounds if f in figures}
            good = (row.stops or not stopped) and bool(judged) and all(passes(v, *row.bounds[f])
                                                                       for f, v in judged.items())
            if set(judged) != set(row.bounds) and not (set(row.bounds) - set(judged)
                                                       <= {"ranks_differ"}):
                good = False
            entry["recipes"].setdefault(recipe, {})[group] = {"figures": judged,
                                                              "stopped": stopped, "pass": good,
                                                              "given": summary["given"]}
        for recipe, runs in entry["recipes"].items():
            entry[recipe] = {"pass": all(run["pass"] for run in runs.values()), "runs": len(runs),
                             "kept": {f: all(passes(r["figures"].get(f), *row.bounds[f])
                                             or f == "ranks_differ" for r in runs.values())
                                      for f in row.bounds},
                             "worst": {f: worst(row.bounds[f][0], [
                                 r["figures"][f] for r in runs.values() if f in r["figures"]])
                                       for f in row.bounds},
                             "stopped": next((f"{g}: {r['stopped']}" for g, r in runs.items()
                                              if r["stopped"]), None)}
        if entry["recipes"]:
            table.append(entry)
    return table


def worst(relation, values):
    values = [v for v in values if v is not None]
    if not values:
        return None
    return min(values) if relation in (">", ">=", "==") else max(values)


def told(entry, recipe):
    """Worst figures of a row's recipe, as text."""
    if recipe not in entry:
        return "not run"
    found = entry[recipe]
    parts = [f"{label(f)} {quantity(f, v)}" for f, v in found["worst"].items() if v is not None]
    if found["stopped"]:
        parts.append(f"stopped, {found['stopped']}")
    return "; ".join(parts) or "-"


def verdict(entry, recipe):
    return "" if recipe not in entry else "pass" if entry[recipe]["pass"] else "FAIL"


def terminal(table):
    """The table for the terminal."""
    for e in table:
        print(f"{e['case']}  [{', '.join(e['bounds'].values())}]")
        for recipe in e["recipes"]:
            print(f"    {recipe:12} {verdict(e, recipe):4}  {told(e, recipe)}")


PICTURED = {"patch": "spinning patch of water", "obstacle": "elastic obstacle",
            "drop": "stretched drop", "pull": "plate pulled out of water"}


def thumbnails(path, cases):
    """The last picture of some groups in equal squares, a row for each of RECIPES; what they show,
    for hard.json. Water is blue, solids are orange."""
    shown = [group for group in PICTURED if all(f"{group}.{recipe}" in cases for recipe in RECIPES)]
    if not shown:
        return []
    found, rows = [], len(RECIPES)
    with plot.picture(path, 2.0 * len(shown), 2.0 * rows) as figure:
        for k, group in enumerate(shown):
            runs = {recipe: frames_of(cases[f"{group}.{recipe}"]) for recipe in RECIPES}
            found.append({"group": group, "title": PICTURED[group],
                          "times": {recipe: frames[-1].time for recipe, frames in runs.items()}})
            first = runs["best"][0]
            ends = np.concatenate([first.vector("xy"), runs["best"][-1].vector("xy")])
            low, high = (np.quantile(ends, q, axis=0) for q in (0.002, 0.998))
            middle, half = 0.5 * (low + high), 0.54 * (high - low).max()
            for row, frames in enumerate(runs.values()):
                axes = figure.add_axes((k / len(shown) + 0.005, 1 - (row + 0.99) / rows,
                                        1 / len(shown) - 0.01, 0.98 / rows))
                for kind, colour in ((1, plot.BLUE), (2, plot.ORANGE)):
                    part = frames[-1].of_types(kind)
                    axes.plot(part["x"], part["y"], ".", markersize=1.2 if len(first) > 1500
                              else 2.0, color=colour)
                axes.set(xlim=(middle[0] - half, middle[0] + half),
                         ylim=(middle[1] - half, middle[1] + half), aspect="equal")
                axes.axis("off")
    return found


def study(folder, cases):
    """hard.json, hard.csv and thumbnails.png of all rows, which tools/renew makes a page of; an
    error names the rows that `best` misses."""
    folder = Path(folder)
    summary = Summary(folder)
    table = collect(summary.cases)
    about = {key: summary.run.get(key) for key in ("commit", "date")}
    (folder / "hard.json").write_text(json.dumps(
        {"command": "tools/run hard", **about,
         "cpu_seconds": round(sum(case["cpu_seconds"] or 0 for case in summary.cases.values())),
         "particle_steps": sum(case["particle_steps"] or 0 for case in summary.cases.values()),
         "runs": len(summary.cases),
         "pictures": thumbnails(folder / "thumbnails.png", cases), "rows": table}, indent=1) + "\n")
    with open(folder / "hard.csv", "w", newline="", encoding="utf-8") as file:
        file.write(f"# tools/run hard; commit {about['commit']}, {about['date']}\n")
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(("row", "figure", "relation", "bound", "recipe", "run", "value", "stopped"))
        for e in table:
            for recipe, runs in e["recipes"].items():
                for group, run in runs.items():
                    rows.writerows((e["row"], f, *ROWS[e["row"]].bounds[f], recipe, group,
                                    run["figures"].get(f), run["stopped"] or "")
                                   for f in e["bounds"])
    missed = {recipe: [e["row"] for e in table if recipe in e and not e[recipe]["pass"]]
              for recipe in RECIPES}
    for e in table:
        for recipe in e["recipes"]:
            summary.add(f"{e['row']}_{recipe}", verdict(e, recipe))
    for recipe, those in missed.items():
        summary.add(f"rows_missed_by_{recipe}", len(those), target=0 if recipe == "best" else None)
    summary.write()
    terminal(table)
    if missed["best"]:
        raise SystemExit(f"hard: the best recipe misses {', '.join(missed['best'])}")
    return summary


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
