#!/usr/bin/env python3
"""Figures and pictures of a cylinder that falls into water.   usage: analyze.py FOLDER

main reads cylinder.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import plot, series  # noqa: E402

EXPERIMENT, CODE = "experiment, Greenhow & Lin 1983", "code, boundary elements in Sun et al. 2018"
DIAMETER, G = 0.11, 9.81
COLORS = (plot.BLUE, plot.ORANGE)


def depth(folder):
    """(time [sqrt(D/g)], depth of the lowest point [D])"""
    s = series.read(Path(folder) / "cylinder.csv")
    return s.time * np.sqrt(G / DIAMETER), -s["low"] / DIAMETER


def add(summary, folder, suffix, target):
    """The figures of one run: at the last instants of the experiment, and the largest distance from
    the code"""
    time, found = depth(folder)
    measured, code = series.read(HERE / "experiment.csv"), series.read(HERE / "code.csv")
    for at, of in zip(measured.time[-2:], measured["depth"][-2:]):
        if at < time[-1]:
            summary.add(f"depth_at_{at:.2f}{suffix}", float(np.interp(at, time, found)), "D",
                        float(of), EXPERIMENT, target)
    seen = measured.time < time[-1]
    summary.add("apart_from_experiment" + suffix, float(
        np.abs(np.interp(measured.time, time, found) - measured["depth"])[seen].max()), "D",
                target=target)
    seen = code.time < time[-1]
    summary.add("apart_from_code" + suffix,
                float(np.abs(np.interp(code.time, time, found) - code["depth"])[seen].max()), "D")


def draw(folder, cases):
    measured, code = series.read(HERE / "experiment.csv"), series.read(HERE / "code.csv")
    plot.lines(Path(folder) / "depth.png", "time [sqrt(D/g)]", "depth of the lowest point [D]",
               [(*depth(path), name if name == "SPH" else f"{name} particles per diameter", color)
                for (name, path), color in zip(cases.items(), COLORS)],
               [(measured.time, measured["depth"], EXPERIMENT, plot.GREY),
                (code.time, code["depth"], CODE, plot.GREEN)])


def study(folder, cases):
    """Figures of all cases; the finest is judged and shown."""
    return plot.bodies(folder, cases, add, draw, every=1, limits=((-0.5, 0.5), (-0.3, 0.3)),
                       panel_width=2.6)


def main(folder):
    """Analyzes the run in `folder`; returns the summary."""
    return study(folder, {"SPH": folder})


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
