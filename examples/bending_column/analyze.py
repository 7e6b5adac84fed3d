#!/usr/bin/env python3
"""Figures and pictures of the bending column.   usage: analyze.py FOLDER

main reads column.csv, particles.dump and log.lammps of one run and writes summary.json, top.png and
column.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

# finite elements, extrapolated over three meshes: first peak [m] and first return through zero [s]
# of the top
PEAK, CROSSING = 2.99, 0.910
SOURCE = "finite elements, independent"
SNAPSHOTS = (0.0, 0.25, 0.45, 0.9, 1.35)  # [s]


def add(summary, column, suffix=""):
    """Figures of the top's horizontal displacement and of the energy."""
    peak = float(column["ux"][column.time < 0.75].max(initial=0.0))
    summary.add(f"peak{suffix}", peak, "m", PEAK, SOURCE, 0.03)
    k = np.flatnonzero((column["ux"][:-1] > 0.0) & (column["ux"][1:] <= 0.0))
    crossing = None
    if len(k):
        a, b = column["ux"][k[0]], column["ux"][k[0] + 1]
        crossing = column.time[k[0]] + a / (a - b) * (column.time[k[0] + 1] - column.time[k[0]])
    summary.add(f"zero_crossing{suffix}", crossing, "s", CROSSING, SOURCE, 0.03)
    summary.add(f"energy_error{suffix}", np.abs(column["total"] / column["total"][0] - 1.0).max(),
                "of the energy", target=0.01)


def picture_column(path, frames, spacing):
    """The column from the side, coloured by von Mises stress."""
    top = 1e-6 * np.percentile(np.concatenate([frame["vonmises"] for frame in frames]), 99.5)
    plot.clouds(path, [(f"t = {f.time:.2f} s", f["x"], f["y"], 1e-6 * f["vonmises"], f["z"])
                       for f in frames], spacing,
                ((-3.2, 4.2), (-0.7, 6.6)), "von Mises stress [MPa]", (0.0, max(top, 1e-9)),
                panel_width=1.7, colours=plot.SOLID_COLOURS)


def picture_top(path, runs):
    """Displacement of the top. runs: [(column, label)]."""
    plot.lines(path, "time [s]", "horizontal displacement of the top [m]",
               [(column.time, column["ux"], label, colour)
                for (column, label), colour in zip(runs, (plot.BLUE, plot.ORANGE))],
               [(np.array([CROSSING]), np.array([0.0]), "finite elements, return", plot.GREY)],
               levels=[(PEAK, "finite elements, peak")])


def read(folder):
    """What a run left: the top over time and the values of the log."""
    return series.read(Path(folder) / "column.csv"), log.read(Path(folder) / "log.lammps").values


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    column, values = read(folder)
    add(summary, column)
    picture_top(folder / "top.png",
                [(column, f"{values['across']:.0f} particles through the thickness")])
    picture_column(folder / "column.png",
                   dump.nearest(dump.read(folder / "particles.dump"), SNAPSHOTS, 0.1), values["dx"])
    return summary.write()


def study(folder, cases):
    """All cases."""
    summary = Summary(folder)
    runs = []
    for path in cases.values():
        column, values = read(path)
        add(summary, column, f"_{values['across']:.0f}")
        runs.append((column, f"{values['across']:.0f} particles through the thickness"))
    picture_top(Path(folder) / "top.png", runs)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
