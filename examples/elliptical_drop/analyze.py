#!/usr/bin/env python3
"""Figures and pictures of the elliptical drop.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.summary import Summary  # noqa: E402

EXACT = "exact solution, an ODE (Monaghan 1994)"
LABELS = {"best": "shifting", "coarse": "shifting, dx doubled", "plain": "no shifting"}


def exact(times, rate):
    """Semi-axes (a, b) at `times`: da/dt = -A a, db/dt = A b, dA/dt = A^2 (a^2 - b^2)/(a^2 + b^2),
    by Runge-Kutta."""
    def slope(y):
        A, a, b = y
        return np.array([A * A * (a * a - b * b) / (a * a + b * b), -a * A, b * A])

    y, now, found = np.array([rate, 1.0, 1.0]), 0.0, []
    for time in times:
        steps = max(1, int(np.ceil((time - now) * rate / 1e-3)))
        dt = (time - now) / steps
        for _ in range(steps):
            k1 = slope(y)
            k2 = slope(y + 0.5 * dt * k1)
            k3 = slope(y + 0.5 * dt * k2)
            k4 = slope(y + dt * k3)
            y = y + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        now = time
        found.append(y[1:])
    return np.array(found).T


def figures(folder):
    """{name: (value, unit, reference, source)} of a run, and its series and exact semi-axes."""
    values, table = log.read(Path(folder) / "log.lammps").values, series.read(
        Path(folder) / "series.csv")
    a, b = exact(table.time, values["rate"])
    last = dump.read(Path(folder) / "particles.dump")[-1]
    found = {
        "semi_axis_b": (float(table["b"][-1]), "m", float(b[-1]), EXACT),
        "semi_axis_a": (float(table["a"][-1]), "m", float(a[-1]), EXACT),
        "b_error_worst": (np.abs(table["b"] / b - 1.0).max(), "", None, None),
        "kinetic_energy_drift": (table["ke"][-1] / table["ke"][0] - 1.0, "", None, None),
        "min_pair_distance": (min_pair_distance(last.vector("xy"), values["dx"]) / values["dx"],
                              "dx", None, None),
    }
    return found, table, (a, b), values["dx"]


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    found, table, (a, b), spacing = figures(folder)
    for name, (value, unit, reference, source) in found.items():
        summary.add(name, value, unit, reference, source)
    plot.lines(folder / "axes.png", "time [ms]", "semi-axis [m]",
               [(1e3 * table.time, table["b"], "b, SPH", plot.BLUE),
                (1e3 * table.time, table["a"], "a, SPH", plot.GREY)],
               [(1e3 * table.time[::40], y[::40], label, plot.ORANGE)
                for y, label in ((b, "exact"), (a, None))])
    frames = dump.read(folder / "particles.dump")
    shown = dump.nearest(frames, (0.0, 0.5 * frames[-1].time, frames[-1].time), frames[-1].time)
    plot.clouds(folder / "drop.png", [(f"t = {1e3 * f.time:.1f} ms", f["x"], f["y"], 1e-6 * f["p"])
                                      for f in shown], spacing,
                ((-1.2, 1.2), (-2.1, 2.1)), "pressure [MPa]", (0.0, 5.0), panel_width=1.7)
    return summary.write()


def study(folder, cases):
    """The first case's figures are the scene's; the others' have its name behind theirs."""
    folder = Path(folder)
    summary = Summary(folder)
    curves = []
    for k, (name, path) in enumerate(cases.items()):
        found, table, (_, b), _ = figures(path)
        for figure, (value, unit, reference, source) in found.items():
            summary.add(figure + (f"_{name}" if k else ""), value, unit, reference, source,
                        0.01 if not k and figure == "semi_axis_b" else None)
        curves.append((1e3 * table.time, 100.0 * (table["b"] / b - 1.0), LABELS.get(name, name),
                       (plot.BLUE, plot.ORANGE, plot.GREY)[k % 3]))
    plot.lines(folder / "error.png", "time [ms]", "error of the semi-axis b [%]", curves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
