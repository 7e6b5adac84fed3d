#!/usr/bin/env python3
"""Figures and pictures of the twisting column.   usage: analyze.py FOLDER

Reads column.csv, particles.dump and log.lammps in FOLDER, which tools/run makes; writes
summary.json, twist.png and column.png there.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SNAPSHOTS = 5  # pictures from the start to the end of the first unwinding


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    spacing = summary.log.values["dx"]
    column = series.read(folder / "column.csv")
    # the rotation of the top layer is known up to whole turns; it turns far less than half a turn
    # between two lines
    turns = np.unwrap(np.arctan2(column["cross"], column["dot"])) / (2.0 * np.pi)
    turns *= np.sign(turns[np.argmax(np.abs(turns))])
    time = column.time
    largest = int(np.argmax(turns[time < 0.2]))
    back = largest + int(np.argmax(turns[largest:] <= 0.0))
    unwound = turns[back] <= 0.0

    summary.add("largest_twist", turns[largest], "turns")
    summary.add("largest_twist_time", time[largest], "s")
    summary.add("unwound_time", time[back] if unwound else None, "s")
    if unwound:
        summary.add("twist_the_other_way", -turns[back:].min() / turns[largest], "of the first")
    summary.add("energy_error", np.abs(column["total"] / column["total"][0] - 1.0).max(),
                "of the energy", target=0.01)
    frames = dump.read(folder / "particles.dump")
    off = [np.hypot(f["x"].mean(), f["z"].mean()) for f in frames]
    summary.add("axis_drift", max(off) / spacing, "dx")

    plot.lines(folder / "twist.png", "time [s]", "rotation of the top [turns]",
               [(time, turns, "rotation", plot.BLUE)])
    times = np.linspace(0.0, time[back] if unwound else time[-1], SNAPSHOTS)
    picture(folder / "column.png", dump.nearest(frames, times, tolerance=time[-1]), spacing)
    return summary.write()


def picture(path, frames, spacing):
    """The column from the side, front particles over those behind, coloured by von Mises stress."""
    top = 1e-6 * np.percentile(np.concatenate([frame["vonmises"] for frame in frames]), 99.5)
    plot.clouds(path, [(f"{1e3 * f.time:.0f} ms", f["x"], f["y"], 1e-6 * f["vonmises"], f["z"])
                       for f in frames], spacing,
                ((-0.9, 0.9), (-0.9, 6.5)), "von Mises stress [MPa]", (0.0, max(top, 1e-9)),
                panel_width=1.0, colours=plot.SOLID_COLOURS)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
