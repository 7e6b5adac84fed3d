#!/usr/bin/env python3
"""Figures and pictures of the folded strip.   usage: analyze.py FOLDER

main reads strip.csv, particles.dump and log.lammps of one run and writes summary.json, length.png
and strip.png beside them; study compares the runs of cases.json.
"""

import shutil
import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

YOUNG, POISSON, DENSITY = 1.0e6, 0.3, 1000.0
THEORY = "Timoshenko beam on a rigid plane"
TARGET, LENGTH = 0.01, 0.05  # of displacements; of the free length: half a thickness
SETTLED = 0.5  # [s] until then the arms, which are damped, lag behind the load
COLOURS = (plot.BLUE, plot.GREEN, plot.ORANGE)


def theory(free, values, shear=True):
    """(acceleration [m/s^2], mean displacement [m]) at which an arm is free from its clamp to s =
    `free` and lies on the other one beyond.

    By symmetry the other arm is a plane at the distance d = gap/2. With l^2 = EI/(k G A) the
    rotation phi of the cross-sections obeys EI phi_xxx = q, the deflection w_x = phi - l^2 phi_xx.
    On the plane w_x = 0, so phi decays as exp(-x/l); phi, phi_x, w_x and w = d are continuous at s:
    phi = c (x^3 + a x^2 + b x) with q = 6 EI c. Without shear: q = 72 EI d/s^4, mean w = d (1 - 0.4
    s/L).
    """
    s, thick, apart = np.asarray(free), values["thickness"], 0.5 * values["gap"]
    bending = YOUNG / (1.0 - POISSON**2) * thick**3 / 12.0
    decay = (np.sqrt(bending / (5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * thick)) if shear
             else 0.0)
    if shear:
        # of a, b: phi = l^2 phi_xx at s
        first = (s**2 - 2.0 * decay**2, s, 6.0 * decay**2 * s - s**3)
        # phi_x = -phi/l there
        second = (2.0 * s + s**2 / decay, 1.0 + s / decay, -3.0 * s**2 - s**3 / decay)
        whole = first[0] * second[1] - first[1] * second[0]
        a = (first[2] * second[1] - first[1] * second[2]) / whole
        b = (first[0] * second[2] - first[2] * second[0]) / whole
    else:
        a, b = -2.0 * s, s**2
    c = apart / (s**4 / 4.0 + a * s**3 / 3.0 + b * s**2 / 2.0 - decay**2
                 * (3.0 * s**2 + 2.0 * a * s))
    area = c * (s**5 / 20.0 + a * s**4 / 12.0 + b * s**3 / 6.0 - decay**2
                * (s**3 + a * s**2)) + apart * (values["length"] - s)
    return 6.0 * bending * c / (DENSITY * thick), area / values["length"]


def table(values):
    """Free length, acceleration and mean displacement from the first flat contact, of the arm's
    end, to a third of the length."""
    free = values["length"] * np.linspace(1.0, 0.33, 400)
    return (free, *theory(free, values))


def touching(frame, values):
    """(where contact begins [m], or None; distance of the arms' facing rows where it is least, in
    spacings)"""
    dx, half = values["dx"], 0.5 * values["gap"]
    upper, lower = (frame.select(rows) for rows in values["rows"])
    distance = np.hypot(upper["x"] - lower["x"], upper["y"] - lower["y"]) / dx
    at = np.flatnonzero((distance < values["reach"]) & (values["column"] > half))
    return (values["column"][at].min() - 0.5 * dx if len(at) else None), distance.min()


def facing(first, values):
    """Adds to `values` which particles face each other at the start, by column, and the columns'
    places."""
    dx, half, mouth = values["dx"], 0.5 * values["gap"], first["x"] > 0.0
    values["rows"] = [mouth & (np.abs(first["y"] - side * (half + 0.5 * dx)) < 0.25 * dx)
                      for side in (1.0, -1.0)]
    values["column"] = first["x"][values["rows"][0]]
    assert np.allclose(values["column"], first["x"][values["rows"][1]])


def read(folder):
    """(load and mean displacement over time, values of the log, frames, where contact begins in
    each, least distance of all)"""
    strip, values = series.read(Path(folder) / "strip.csv"), log.read(Path(folder)
                                                                      / "log.lammps").values
    frames = dump.read(Path(folder) / "particles.dump")
    facing(frames[0], values)
    begins, nearest = zip(*(touching(frame, values) for frame in frames))
    return strip, values, frames, begins, min(nearest)


def add(summary, run, suffix=""):
    """Mean displacement and free length at the last load, the largest error since the arms have
    come together."""
    strip, values, _, begins, nearest = run
    free, load, mean = table(values)
    if strip["push"][-1] > load[0] and strip.time[-1] > SETTLED:
        late, expected = strip.time > SETTLED, np.interp(strip["push"], load, mean)
        summary.add(f"mean_displacement{suffix}", 1e3 * strip["closed"][-1], "mm",
                    1e3 * expected[-1], THEORY, TARGET)
        summary.add(f"largest_error{suffix}", np.abs(strip["closed"] / expected - 1.0)[late].max(),
                    "of the mean displacement", target=TARGET)
        beam = 1e3 * np.interp(strip["push"][-1], load, free)
        summary.add(f"free_length{suffix}", 1e3 * begins[-1] if begins[-1] else None, "mm", beam,
                    THEORY, LENGTH)
    summary.add(f"nearest_rows{suffix}", nearest, "dx")
    summary.add(f"asymmetry{suffix}", np.abs(strip["drift"]).max() / values["dx"], "dx",
                target=1e-6)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    run = read(folder)
    add(summary, run)
    picture_length(folder / "length.png", [run])
    picture_strip(folder / "strip.png", run)
    return summary.write()


def picture_length(path, runs):
    """Length in contact and mean displacement over the load, against the beam, once the arms have
    come together."""
    with plot.picture(path, 8.4, 3.5) as figure:
        panels = figure.subplots(1, 2)
        free, load, mean = table(runs[0][1])
        some = (load > 0.2 * runs[0][0]["push"][-1]) & (load < 1.1 * runs[0][0]["push"][-1])
        panels[0].plot(load[some], 1e3 * (runs[0][1]["length"] - free[some]), color=plot.GREY,
                       label="beam")
        panels[1].plot(load[some], 1e3 * mean[some], color=plot.GREY, label="beam")
        for (strip, values, frames, begins, _), colour, marker in zip(runs, COLOURS, "os^"):
            shown = [k for k, frame in enumerate(frames) if frame.time >= SETTLED
                     and begins[k]][::2]
            time = [frames[k].time for k in shown]
            push = np.interp(time, strip.time, strip["push"])
            style = {"markersize": 5, "markerfacecolor": "none", "color": colour,
                     "label": f"{values['across']:g} particles through an arm"}
            panels[0].plot(push, [1e3 * (values["length"] - begins[k]) for k in shown], marker,
                           **style)
            panels[1].plot(push, 1e3 * np.interp(time, strip.time, strip["closed"]), marker,
                           **style)
        for axes, label in zip(panels, ("length in contact [mm]", "mean displacement [mm]")):
            axes.set(xlabel="acceleration of the arms [m/s$^2$]", ylabel=label)
        panels[1].legend(loc="lower right")
        figure.tight_layout()


def picture_strip(path, run):
    """The strip before, as its arms come together, and at the last load."""
    _, values, frames, *_ = run
    shown = [replace(frame, columns={**frame.columns, "x": 1e3 * frame["x"], "y": 1e3 * frame["y"]})
             for frame in dump.nearest(frames, [0.0, 0.6 * SETTLED, frames[-1].time],
                                       tolerance=frames[-1].time)]
    plot.snapshots(path, shown, 1e3 * values["dx"], fluid=(), solid=(1, 2), columns=1,
                   panel_width=6.0, labels=("x [mm]", "y [mm]"))


def study(folder, cases):
    """The figures of all cases, and their curves."""
    folder = Path(folder)
    summary = Summary(folder)
    runs = {name: read(path) for name, path in cases.items()}
    for name, run in runs.items():
        add(summary, run, f"_{name}")
    picture_length(folder / "length.png", list(runs.values()))
    shutil.copyfile(Path(list(cases.values())[-1]) / "strip.png", folder / "strip.png")
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
