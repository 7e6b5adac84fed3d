#!/usr/bin/env python3
"""Figures and pictures of a disc that settles.   usage: analyze.py FOLDER

main reads disc.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import plot, series  # noqa: E402

SOURCE = "code, finite elements, Glowinski et al. 2001"
EVEN = 0.35, 0.62  # [s] from when the speed is even to before the floor brakes
COLORS = (plot.BLUE, plot.ORANGE)


def even_speed(s):
    """Mean downward speed, of points that lie apart"""
    times = np.linspace(*EVEN, 100)
    return -s.at("v", times).mean()


def add(summary, folder, suffix, target):
    """The figures of one run"""
    s, code = series.read(Path(folder) / "disc.csv"), series.read(HERE / "code.csv")
    if s.time[-1] > EVEN[1]:
        summary.add("terminal_speed" + suffix, 1e3 * even_speed(s), "mm/s", 1e3 * even_speed(code),
                    SOURCE, target)
    summary.add("speed_at_0.1_s" + suffix, -1e3 * float(s.at("v", 0.1)), "mm/s",
                -1e3 * float(code.at("v", 0.1)), SOURCE, target)


def draw(folder, cases):
    runs = [(series.read(Path(path) / "disc.csv"), name, color)
            for (name, path), color in zip(cases.items(), COLORS)]
    code = series.read(HERE / "code.csv")
    plot.lines(Path(folder) / "speed.png", "time [s]", "speed of the disc [mm/s]",
               [(s.time, -1e3 * s["v"], name if name == "SPH" else f"{name} particles per diameter",
                 color) for s, name, color in runs],
               [(code.time, -1e3 * code["v"], "code, finite elements", plot.GREY)])


def study(folder, cases):
    """Figures of all cases; the finest is judged and shown."""
    return plot.bodies(folder, cases, add, draw, limits=((0.0, 0.02), (0.0, 0.06)), panel_width=1.3)


def main(folder):
    """Analyzes the run in `folder`; returns the summary."""
    return study(folder, {"SPH": folder})


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
