#!/usr/bin/env python3
"""Figures and pictures of the starter grains.   usage: analyze.py FOLDER"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SHOWN = (0.1, 0.2, 0.3, 0.4)  # [s]
THICK = 6  # particles across the slice


def main(folder):
    """Reads particles.dump and log.lammps; writes summary.json and snapshots.png."""
    summary, frames = Summary(folder), dump.read(Path(folder) / "particles.dump")
    first, last = frames[0], frames[-1]
    grain = first["type"] == 2
    dx = np.ptp(first["z"][~grain]) / (THICK - 1)
    moved = last["x"] - first["x"]
    summary.add("bed_moved", float(moved[grain].mean()), "m")
    summary.add("part_of_grains_moved_20_mm", float((moved[grain] > 0.02).mean()))
    summary.add("particles_lost", int(len(first) - len(last)), target=0)
    shown = dump.nearest(frames, SHOWN, 0.02) or frames[-1:]  # of a run that ends before
    for frame in shown:
        frame.columns["speed"] = np.hypot(frame["vx"], frame["vy"])
    # the two layers in the middle of the slice
    middle = [frame.select(np.abs(frame["z"] - 0.5 * THICK * dx) < dx) for frame in shown]
    plot.snapshots(Path(folder) / "snapshots.png", middle, dx, limits=((0.0, 0.4), (0.0, 0.14)),
                   colour="speed", columns=2, panel_width=3.6, wall=(2,))
    summary.write()


if __name__ == "__main__":
    main(sys.argv[1])
