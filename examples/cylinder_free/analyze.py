#!/usr/bin/env python3
"""Figures and pictures of the flow around a cylinder in a free stream.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, geometry, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

# {(Reynolds number, width, upstream, downstream of the box [D]): {figure: value}}: finite elements
# in the same box (box.edp with -around 96)
BOX = "finite elements in the same box (box.edp)"
REFERENCE = {
    (100, 16, 6, 8): {"drag": 1.431, "lift": 0.355, "strouhal": 0.1753},
    (200, 16, 6, 8): {"drag": 1.423, "lift": 0.751, "strouhal": 0.2052},
    (100, 10, 5, 6): {"drag": 1.479, "lift": 0.330, "strouhal": 0.1790},
}
TARGETS = {"drag": 0.02, "lift": 0.05, "strouhal": 0.02}
DIAMETER = 0.1
PERIODS = 5
START = 1.0  # of the curves: what the sudden start does before is off the scale
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREEN, plot.GREY)


def read(folder):
    """(values of the log, time in D/U, coefficients by name)"""
    s = series.read(Path(folder) / "series.csv")
    values = log.read(Path(folder) / "log.lammps").values
    factor = 2.0 / (1000.0 * values["velocity"]**2 * DIAMETER)
    return values, s.time * values["velocity"] / DIAMETER, {name: s[name] * factor
                                                            for name in ("drag", "lift", "push")}


def figures(time, found):
    """Of the last five periods: mean drag, amplitude of the lift's harmonics, Strouhal number, what
    the stream's zone pushes in the mean; and the amplitude of the five before, which is the same
    once the vortices have grown up. Sound, whose frequencies are others, does not count."""
    late = time >= 0.5 * time[-1]
    rate = series.frequency(time[late], series.smooth(time, found["lift"], 2.0)[late])
    end = time >= time[-1] - PERIODS / rate
    out = {"drag": found["drag"][end].mean(),
           "lift": series.swing(time, found["lift"], rate, PERIODS)[1], "strouhal": rate,
           "push": found["push"][end].mean()}
    if time[~end][-1] * rate >= PERIODS:
        out["lift_before"] = series.swing(time[~end], found["lift"][~end], rate, PERIODS)[1]
    return out


def add(summary, folder, suffix="", judged=False):
    """The figures of one run; returns the time and the smoothed coefficients."""
    values, time, found = read(folder)
    box = tuple(round(values[name]) for name in ("reynolds", "width", "upstream", "downstream"))
    references = REFERENCE.get(box, {})
    for name, value in figures(time, found).items():
        reference = references.get(name)
        summary.add(name + suffix, value, "", reference, BOX if reference else None,
                    TARGETS[name] if judged and reference else None)
    return time, {name: series.smooth(time, c, 0.5) for name, c in found.items()}


def label(folder):
    """Of a curve: Reynolds number and resolution of a run."""
    values = log.read(Path(folder) / "log.lammps").values
    levels = json.loads((Path(folder) / "run.json").read_text())["variables"].get("levels", "0")
    across = DIAMETER / values["dx"]
    finest = f" to {across * 2**(int(levels) / 2):.0f}" if int(levels) else ""
    return f"Re = {values['reynolds']:.0f}, {across:.0f}{finest} particles per diameter"


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    time, found = add(summary, folder)
    shown = time > START
    plot.lines(folder / "forces.png", "t U/D", "coefficient, means of 0.5 D/U",
               [(time[shown], found[name][shown], name, colour)
                for name, colour in zip(("drag", "lift"), COLOURS)])
    values = summary.log.values
    last = dump.read(folder / "particles.dump")[-1]
    last = last.select(last["type"] != 2)
    spin = geometry.vorticity_of_levels(last, values["dx"]) * DIAMETER / values["velocity"]
    x, y = last["x"] / DIAMETER, last["y"] / DIAMETER
    plot.clouds(folder / "vorticity.png",
                [(f"t U/D = {last.time * values['velocity'] / DIAMETER:.0f}", x, y, spin)],
                values["dx"] / DIAMETER, ((x.min(), x.max()), (-4, 4)), "vorticity D/U",
                (-3.0, 3.0), axis_labels=("x/D", "y/D"), panel_width=7.0, colours="RdBu_r")
    return summary.write()


def study(folder, cases):
    """Figures of all cases, their lift in one picture."""
    folder = Path(folder)
    summary = Summary(folder)
    # they are in the order of resolution
    finest = {round(read(path)[0]["reynolds"]): name for name, path in cases.items()}
    curves = {reynolds: [] for reynolds in finest}
    for name, path in cases.items():
        time, found = add(summary, path, f"_{name}", name in finest.values())
        shown = time > START
        curves[round(read(path)[0]["reynolds"])].append((time[shown], found["lift"][shown],
                                                         label(path)))
    curves = [(*curve, colour) for curve, colour in zip(
        (c for of_one in curves.values() for c in of_one[-2:]), COLOURS)]
    plot.lines(folder / "lift.png", "t U/D", "lift coefficient, means of 0.5 D/U", curves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
