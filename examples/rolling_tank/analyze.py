#!/usr/bin/env python3
"""Figures and pictures of the rolling tank.   usage: analyze.py FOLDER

main reads tank.csv, particles.dump and log.lammps of one run and writes summary.json, tank.png and
snapshots.png beside them; study collects the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

OIL, BAFFLE, WALL = 1, 2, 3
REST = 0.8  # [s] after a pulse the tank is at rest
THEORY = "linear theory of waves between walls"


def first_period(half, depth, gravity=9.81):
    """Of sloshing in a box of length 2 half, by linear theory."""
    k = np.pi / (2.0 * half)
    return 2.0 * np.pi / np.sqrt(gravity * k * np.tanh(k * depth))


def period(time, value):
    """Of the sine with an offset that fits best; None if less than the longest period tried is
    there."""
    periods = np.linspace(0.9, 1.6, 1401)
    if time[-1] - time[0] < periods[-1]:
        return None
    misfit = [np.linalg.lstsq(
        np.column_stack([np.sin(w * time), np.cos(w * time), np.ones_like(time)]), value,
        rcond=None)[1][0]
              for w in 2.0 * np.pi / periods]
    return float(periods[int(np.argmin(misfit))])


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values = summary.log.values
    dx, half, height = (values[name] for name in ("dx", "half", "height"))
    history = series.read(folder / "tank.csv")
    frames = dump.read(folder / "particles.dump")

    leaks = Leaks(0.5 * dx)
    for frame in frames:
        oil = frame.of_types(OIL)
        # the last picture may be a digit later than the last line
        roll = np.radians(
            history.at("roll", [np.clip(frame.time, history.time[0], history.time[-1])])[0])
        oil.columns["along"] = np.cos(roll) * oil["x"] + np.sin(roll) * oil["y"]
        oil.columns["up"] = np.cos(roll) * oil["y"] - np.sin(roll) * oil["x"]
        leaks.see(oil)
        leaks.beyond_walls(oil, [("along", -half, -1), ("along", half, 1), ("up", 0.0, -1),
                                 ("up", height, 1)])
    nearest = min_pair_distance(frames[-1].vector(), dx) / dx

    pulse = history["roll"][-1] == 0.0
    if values["baffle"] > 0.0:
        summary.add("tip_left", 1e3 * history["tip"].min(), "mm")
        summary.add("tip_right", 1e3 * history["tip"].max(), "mm")
        summary.add("tip_left_time", float(history.time[np.argmin(history["tip"])]), "s")
        summary.add("largest_roll", float(np.abs(history["roll"]).max()), "degrees")
    if pulse:
        late = history.time > REST
        found = period(history.time[late], history["x"][late])
        if found:
            summary.add("sloshing_period", found, "s", first_period(half, values["depth"]), THEORY,
                        target=0.02)
    summary.add("particles_leaked", leaks.count(summary.log), target=0)
    summary.add("min_pair_distance", nearest, "dx")

    curves = [(history.time, history["roll"], "roll of the tank [degrees]", plot.GREY)]
    if values["baffle"] > 0.0:
        curves.append((history.time, 1e3 * history["tip"],
                       "tip of the baffle across the tank's axis [mm]", plot.BLUE))
    curves.append((history.time, 1e3 * history["x"], "the oil's center of mass along the tank [mm]",
                   plot.ORANGE))
    plot.lines(folder / "tank.png", "time [s]", "in the frame of the tank", curves)
    limits = ((-half - 0.05, half + 0.05), (-0.04, 0.24))
    end = frames[-1].time
    plot.snapshots(folder / "snapshots.png",
                   dump.nearest(frames, tuple(np.linspace(0.2, 1.0, 6) * end), end), dx, (OIL,),
                   (BAFFLE, WALL),
                   limits=limits, columns=2, panel_width=3.6)
    return summary.write()


def study(folder, cases):
    """The figures of all runs."""
    summary = Summary(folder)
    for name in cases:
        for figure in summary.cases[name]["figures"]:
            if figure["name"].startswith(("tip", "sloshing", "particles_leaked")):
                summary.add(f"{figure['name']}_{name}", figure["value"], figure["unit"],
                            figure["reference"], figure["source"], figure["target"])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
