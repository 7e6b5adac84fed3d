#!/usr/bin/env python3
"""Figures and pictures of a square that sinks.   usage: analyze.py FOLDER

main reads square.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import plot, series  # noqa: E402

SOURCE = "experiment, Qiu, Liu & Han 2017"
HEIGHTS = 0.12, 0.04  # [m] of the center: submerged, and before the floor brakes
COLORS = (plot.BLUE, plot.ORANGE)


def passed(s, height):
    """When the center comes by a height on its way down"""
    return float(np.interp(-height, -s["y"], s.time))


def add(summary, folder, suffix, target):
    """The figures of one run: the way through the water, and all of it, from the release on"""
    s, measured = series.read(Path(folder) / "square.csv"), series.read(HERE / "experiment.csv")
    high, low = HEIGHTS
    if s["y"].min() < low:
        summary.add("time_from_120_to_40_mm" + suffix, passed(s, low) - passed(s, high), "s",
                    passed(measured, low) - passed(measured, high), SOURCE, target)
        summary.add("time_to_40_mm" + suffix, passed(s, low), "s", passed(measured, low), SOURCE,
                    target)


def draw(folder, cases):
    runs = [(series.read(Path(path) / "square.csv"), name, color)
            for (name, path), color in zip(cases.items(), COLORS)]
    measured = series.read(HERE / "experiment.csv")
    plot.lines(Path(folder) / "height.png", "time [s]", "height of the center [mm]",
               [(s.time, 1e3 * s["y"], name if name == "SPH" else f"{name} particles along a side",
                 color) for s, name, color in runs],
               [(measured.time, 1e3 * measured["y"], SOURCE, plot.GREY)])


def study(folder, cases):
    """Figures of all cases; the finest is judged and shown."""
    return plot.bodies(folder, cases, add, draw, limits=((0.0, 0.15), (0.0, 0.2)), panel_width=1.9)


def main(folder):
    """Analyzes the run in `folder`; returns the summary."""
    return study(folder, {"SPH": folder})


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
