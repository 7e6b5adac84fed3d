#!/usr/bin/env python3
"""Figures and pictures of the oscillating plate.   usage: analyze.py FOLDER

main() reads tip.csv, particles.dump and log.lammps of one run; study() puts the runs of cases.json
side by side. Both write summary.json and pictures into their folder.
"""

import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

LENGTH, HEIGHT = 0.2, 0.02  # [m]
PLATE, CLAMP = 1, 2  # atom types
# [s] finite elements: root face held; top and bottom faces held in a slot
PERIOD, SLOT_PERIOD = 0.2553, 0.2627
AMPLITUDE = 22.96  # [mm] finite elements, free end starts with 0.01 c0
AMPLITUDE_AT = 0.01
SOURCE = "2D finite elements, ideally clamped face"
FRACTURE = 1.5  # a pair of first neighbours this many spacings apart


def oscillation(tip):
    """(upward zero crossings [s], highest points of the swings [m]): one of each per period,
    parabolic and linear fits.

    The start counts as the first crossing.
    """
    t, y = tip.time, tip["tip_y"]
    up = np.flatnonzero((y[:-1] < 0.0) & (y[1:] >= 0.0))
    down = np.flatnonzero((y[:-1] > 0.0) & (y[1:] <= 0.0))
    crossings = np.concatenate([[0.0], t[up] - y[up] * (t[up + 1] - t[up]) / (y[up + 1] - y[up])])
    peaks = []
    for start in crossings:
        later = down[t[down] > start]
        k, end = np.searchsorted(t, start), later[0] + 1 if later.size else len(t) - 1
        k += int(np.argmax(y[k:end + 1]))
        if k in (0, len(t) - 1):
            break  # cut off before its highest point
        a, b, c = np.polyfit(t[k - 1:k + 2] - t[k], y[k - 1:k + 2], 2)
        peaks.append(c - b * b / (4.0 * a))
    return crossings, np.array(peaks)


def period(crossings, count=None):
    """Mean period [s] of the first `count` swings (all), None if there is not one."""
    crossings = crossings[: None if count is None else count + 1]
    return None if len(crossings) < 2 else float((crossings[-1] - crossings[0])
                                                 / (len(crossings) - 1))


class Lattice:
    """The plate's particles as they lay at the start: columns along x, rows along y."""

    def __init__(self, first, spacing):
        plate = first.of_types(PLATE)
        self.spacing = spacing
        self.order = np.lexsort((plate["y"], plate["x"].round(9)))
        rows = round(HEIGHT / spacing)
        self.shape = (len(plate) // rows, rows)  # a column or so of the length may be held
        self.start = self.grid(first, "x"), self.grid(first, "y")

    def grid(self, frame, name):
        """A column of the dump as an array (columns, rows)."""
        return frame.of_types(PLATE)[name][self.order].reshape(self.shape)

    def whole(self, frame):
        """Whether every particle is still there."""
        return len(frame.of_types(PLATE)) == len(self.order)

    def distances(self, frame):
        """Distances of all pairs of first neighbours over the spacing."""
        x, y = (self.grid(frame, name) for name in "xy")
        return np.concatenate([np.hypot(np.diff(x, axis=a), np.diff(y, axis=a)).ravel()
                               for a in (0, 1)]) / self.spacing

    def disorder(self, frame):
        """Particle by particle zigzag of the displacement over the spacing: second differences
        along both axes / 4, RMS."""
        moved = [self.grid(frame, name) - start for name, start in zip("xy", self.start)]
        squares = [sum(np.mean(np.diff(u, n=2, axis=a) ** 2) for u in moved) / 16.0 for a in (0, 1)]
        return float(np.sqrt(sum(squares)) / self.spacing)

    def zigzag(self, frame, name):
        """Second differences of a field along x (RMS) over its largest value: 4 for a pure zigzag,
        0 for a line."""
        field = self.grid(frame, name)
        return float(np.sqrt(np.mean(np.diff(field, n=2, axis=0) ** 2)) / np.abs(field).max())


def state(folder, spacing, crossings):
    """What the dump says: time of fracture (or None), disorder at the last crossing, stress zigzag
    a quarter period earlier."""
    lattice, found = None, {"fracture": None, "disorder": None, "neighbours": None, "zigzag": None}
    frames, last = [], crossings[-1]
    quarter = 0.25 * (crossings[-1] - crossings[-2]) if len(crossings) > 1 else 0.0
    at = {"disorder": last, "zigzag": last - quarter}
    nearest = {}
    for frame in dump.frames(folder / "particles.dump"):
        lattice = lattice or Lattice(frame, spacing)
        if not lattice.whole(frame):
            found["fracture"] = found["fracture"] or frame.time
            break
        if found["fracture"] is None and lattice.distances(frame).max() > FRACTURE:
            found["fracture"] = frame.time
        for name, time in at.items():
            if name not in nearest or abs(frame.time - time) < abs(nearest[name].time - time):
                nearest[name] = frame
        frames.append(frame)
    if quarter and nearest:
        found["disorder"] = lattice.disorder(nearest["disorder"])
        found["neighbours"] = float(np.mean(np.abs(lattice.distances(nearest["disorder"]) - 1.0)))
        found["zigzag"] = lattice.zigzag(nearest["zigzag"], "sxx")
    return found, frames


def clamp_place(frames, spacing):
    """Where the sections' rotation, continued by a parabola, is zero [m]: the place of the clamp.

    The rotation of a section knows bending only, so shear does not shift the place. The parabola
    goes through the columns from the seventh, beyond what the kernel smooths at the clamp, to four
    tenths of the length. Median over frames of large deflection.
    """
    lattice, places = Lattice(frames[0], spacing), []
    columns = slice(6, max(12, int(0.4 * lattice.shape[0])))
    x, height = lattice.start[0][columns, 0], lattice.start[1][0] - lattice.start[1][0].mean()
    for frame in frames:
        pushed = (lattice.grid(frame, "x") - lattice.start[0])[columns]
        rotation = -(pushed @ height) / (height @ height)
        if abs(rotation[-1]) > 0.01:
            roots = np.roots(np.polyfit(x, rotation, 2))
            roots = roots[np.isreal(roots)].real
            if roots.size:
                places.append(roots[np.argmin(np.abs(roots))])
    return float(np.median(places)) if places else None


def picture_tip(path, curves):
    """Displacement of the free end; curves: list of (Series, label, colour)."""
    with plot.picture(path, 7.2, 3.4) as figure:
        axes = figure.add_subplot()
        end = min(tip.time[-1] for tip, _, _ in curves)
        t = np.linspace(0.0, end, 2000)
        axes.plot(t, AMPLITUDE * np.sin(2.0 * np.pi * t / PERIOD), color=plot.GREY, linewidth=1.0,
                  linestyle="--",
                  label="finite elements: period and amplitude")
        for tip, label, colour in curves:
            axes.plot(tip.time, 1e3 * tip["tip_y"], color=colour, label=label, linewidth=1.3)
        axes.set(xlabel="time [s]", ylabel="deflection of the free end [mm]", xlim=(0.0, end))
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
        figure.tight_layout()


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values, given = summary.log.values, summary.run.get("variables", {})
    tip = series.read(folder / "tip.csv")
    crossings, peaks = oscillation(tip)
    finished = "end" in values and values["end"] > 0.99 * values["tend"]
    reference = AMPLITUDE * float(given.get("vf", AMPLITUDE_AT)) / AMPLITUDE_AT

    summary.add("period", period(crossings), "s", PERIOD, SOURCE)
    if "frequency" in values:
        summary.add("frequency", values["frequency"], "Hz", 1.0 / PERIOD, SOURCE)
    summary.add("amplitude", 1e3 * peaks[0] if len(peaks) else None, "mm", reference, SOURCE)
    for k in (5, 100):
        if len(peaks) >= k:
            summary.add(f"a{k}_a1", peaks[k - 1] / peaks[0], "", 1.0, "no damping")
    # no columns along x, no rows along y
    askew = any(float(given.get(name, 0)) for name in ("turn", "slant"))
    found, frames = ({}, []) if askew else state(folder, values["dx"], crossings)
    summary.add("stopped_at", None if finished else tip.time[-1], "s")
    if found:
        summary.add("fractured_at", found["fracture"], "s")
        summary.add("disorder", found["disorder"], "dx")
        summary.add("neighbour_distance_deviation", found["neighbours"], "dx")
        summary.add("stress_zigzag", found["zigzag"], "")
    if found and len(crossings) > 1:
        place = clamp_place([f for f in frames if f.time < crossings[1]], values["dx"])
        summary.add("clamp_place", None if place is None else place / values["dx"], "dx")
    if (folder / "energy.csv").exists():
        energy = series.read(folder / "energy.csv")
        held = energy["kinetic"] + energy["compression"] + energy["shear"]
        whole = held + energy["by_viscosity"] + energy["by_stress"] + energy["by_gradient"]
        k = int(np.searchsorted(energy.time, min(crossings[-1], energy.time[-1])))
        summary.add("mechanical_energy", held[k] / held[0], "of the start")
        summary.add("energy_drift", float(np.max(np.abs(held[:k + 1] / held[0] - 1.0))),
                    "of the start")
        for name in ("by_viscosity", "by_stress", "by_gradient"):
            summary.add(f"taken_{name}", energy[name][k] / held[0], "of the start")
        summary.add("ledger_error", float(np.max(np.abs(whole[:k + 1] / whole[0] - 1.0))), "")

    picture_tip(folder / "tip.png", [(tip, "this run", plot.BLUE)])
    if frames:
        swing = period(crossings) or PERIOD
        shown = dump.nearest(frames, [0.25 * swing, 0.75 * swing], 0.1 * swing)
        plot.snapshots(folder / "snapshots.png", shown, values["dx"], (), (PLATE, CLAMP), columns=1,
                       panel_width=4.0,
                       limits=((-0.02, 0.21), (-0.04, 0.04)))
    return summary.write()


def figures(folder, what="value"):
    """{figure: value} of a run's summary, or what else it says about a figure."""
    return {f["name"]: f[what]
            for f in json.loads((folder / "summary.json").read_text())["figures"]}


def order(n, error):
    """Order of convergence by least squares in the logarithms; None where it has no meaning."""
    return float(-np.polyfit(np.log(n), np.log(np.abs(error)), 1)[0]) if len(n) > 1 and np.all(
        error) else None


SERIES = {"tl": "total Lagrangian", "ul": "updated, quadratic", "corrected": "updated, linear",
          "paper": "classic SPH"}
COLOURS = {"tl": plot.BLUE, "ul": plot.ORANGE, "corrected": "#2a8c57", "paper": plot.GREY}
TARGETS = {"period_5": 0.02, "period_10": 0.01, "period_10_ul": 0.04}


def study(folder, cases):
    """Convergence with the number of particles across, and long runs.

    Cases are called SERIES_N, N particles across; figures are without a suffix in the
    total-Lagrangian series.
    """
    folder = Path(folder)
    summary = Summary(folder)
    found = {name: figures(path) for name, path in cases.items()}
    table = {}
    for kind in SERIES:
        rows = {int(name[len(kind) + 1:]): values for name, values in found.items()
                if name.startswith(f"{kind}_") and name[len(kind) + 1:].isdecimal()
                and values.get("stopped_at") is None}
        if rows:
            table[kind] = sorted(rows.items())
    for kind, rows in table.items():
        suffix = "" if kind == "tl" else f"_{kind}"
        for n, values in rows:
            name = f"period_{n}{suffix}"
            summary.add(name, values["period"], "s", PERIOD, SOURCE, TARGETS.get(name))
        for n, values in rows:
            summary.add(f"amplitude_{n}{suffix}", values["amplitude"], "mm", AMPLITUDE, SOURCE)
        n, values = rows[-1] if kind != "tl" else next((row for row in rows if row[0] == 10),
                                                       rows[-1])
        for name in ("a5_a1", "disorder", "stress_zigzag", "clamp_place"):
            undamped = (1.0, "no damping") if name == "a5_a1" else (None, None)
            if values.get(name) is None:
                continue  # a short run
            summary.add(f"{name}{suffix}", values.get(name),
                        "dx" if name in ("disorder", "clamp_place") else "", *undamped)
        if len(rows) > 2:
            ns = np.array([n for n, _ in rows], float)
            summary.add(f"order_of_convergence{suffix}",
                        order(ns, np.array([v["period"] for _, v in rows]) / PERIOD - 1.0))
    for kind, suffix in (("tl", ""), ("ul", "_ul")):
        turned = [values["period"] for name, values in found.items()
                  if name.startswith(f"{kind}_5_turned_")]
        if turned and f"{kind}_5" in found:
            summary.add(f"turned_apart{suffix}",
                        max(abs(T / found[f"{kind}_5"]["period"] - 1.0) for T in turned),
                        "of the period", target=0.005)
    for name, values in found.items():
        if "_cut_" in name:
            summary.add(f"period_{name[3:]}", values["period"], "s", PERIOD, SOURCE)
    for suffix, name, loss, drift in (("", "long_5", 0.005, 0.001),
                                      ("_fast", "fast_5", 0.005, 0.001),
                                      ("_ul", "ul_long_5", 0.1, None)):
        values = found.get(name)
        if values is not None:
            summary.add(f"a100_a1{suffix}", values.get("a100_a1"), "", 1.0, "no damping", loss)
            summary.add(f"energy_drift{suffix}", values.get("energy_drift"), "of the start",
                        target=drift)
            summary.add(f"zigzag_100{suffix}", values.get("stress_zigzag"), "", target=0.1)
            summary.add(f"fractured_at{suffix}", values.get("fractured_at"), "s")
    for name, values in found.items():
        if values.get("stopped_at") is not None:
            summary.add(f"stopped_{name}", values["stopped_at"], "s")

    picture_convergence(folder / "convergence.png", {k: r for k, r in table.items() if len(r) > 1})
    return summary.write()


def picture_convergence(path, table):
    """Error of the period against the number of particles across."""
    plot.errors(path, "particles through the thickness", "error of the period [%]", [
        ([n for n, _ in rows], [100.0 * (v["period"] / PERIOD - 1.0) for _, v in rows],
         SERIES[kind], COLOURS[kind]) for kind, rows in table.items()])


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
