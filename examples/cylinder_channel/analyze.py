#!/usr/bin/env python3
"""Figures and pictures of the flow around a cylinder in a channel.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases) compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "Schaefer & Turek 1996, test case 2D-1: 5.57 to 5.59"
DRAG, LIFT = 5.58, 0.0107
TO_COEFFICIENT = 2.0 / (1000.0 * 0.2**2 * 0.1)
COLOURS = (plot.BLUE, plot.ORANGE, "#3a923a", plot.GREY)


def coefficients(folder):
    """Means of drag and lift over the last quarter of the run, and their scatter (standard deviation)"""
    s = series.read(Path(folder) / "series.csv")
    late = s.time >= 0.75 * s.time[-1]
    drag, lift = (s[name][late] * TO_COEFFICIENT for name in ("drag", "lift"))
    return drag.mean(), lift.mean(), drag.std(), lift.std()


def curve(folder):
    """Drag coefficient over time, means of 0.1 s"""
    s = series.read(Path(folder) / "series.csv")
    n = max(1, round(0.1 / (s.time[1] - s.time[0])))
    m = len(s.time) // n * n
    return s.time[:m].reshape(-1, n).mean(1), s["drag"][:m].reshape(-1, n).mean(1) * TO_COEFFICIENT


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    drag, lift, drag_scatter, lift_scatter = coefficients(folder)
    summary.add("drag", drag, "", DRAG, SOURCE)
    summary.add("lift", lift, "", LIFT, "the same, 0.0104 to 0.0110")
    summary.add("drag_scatter", drag_scatter)
    summary.add("lift_scatter", lift_scatter)
    plot.lines(folder / "drag.png", "t [s]", "drag coefficient", [(*curve(folder), "SPH, means of 0.1 s", plot.BLUE)])
    last = dump.read(folder / "particles.dump")[-1]
    last = last.of_types(1)
    plot.clouds(folder / "speed.png", [(f"t = {last.time:.1f} s", last["x"], last["y"], np.hypot(last["vx"], last["vy"]))],
                summary.log.values["dx"], ((-0.3, 1.0), (0, 0.41)), "speed [m/s]", panel_width=8.0)
    return summary.write()


def study(folder, cases):
    """Drag of all cases in one picture."""
    folder = Path(folder)
    summary = Summary(folder)
    finest = "16_across"
    curves = []
    for (name, path), colour in zip(cases.items(), COLOURS):
        drag, lift, scatter, lift_scatter = coefficients(path)
        summary.add(f"drag_{name}", drag, "", DRAG, SOURCE, 0.02 if name == finest else None)
        summary.add(f"lift_{name}", lift, "", LIFT, "the same, 0.0104 to 0.0110")
        summary.add(f"drag_scatter_{name}", scatter)
        curves.append((*curve(path), name.replace("_", " "), colour))
    plot.lines(folder / "drag.png", "t [s]", "drag coefficient, means of 0.1 s", curves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
