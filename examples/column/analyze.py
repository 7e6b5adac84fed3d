#!/usr/bin/env python3
"""Figures and pictures of the starter column.   usage: analyze.py FOLDER"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.animate import spacing  # noqa: E402
from fsi.summary import Summary  # noqa: E402


def main(folder):
    """Reads front.csv, particles.dump and log.lammps; writes summary.json and snapshots.png."""
    summary, s = Summary(folder), series.read(Path(folder) / "front.csv")
    arrival = np.argmax(s["front"] > 0.39)
    summary.add("front_arrival", float(s.time[arrival]), "s")
    settled = s.time > 0.5 * s.time[-1]
    summary.add("floor_load", float(s["floor"][settled].mean()), "weights")
    energy = summary.log.column("c_energy")
    summary.add("energy_error", float(np.abs(energy / energy[0] - 1.0).max()), target=1e-3)
    frames = dump.read(Path(folder) / "particles.dump")
    plot.snapshots(Path(folder) / "snapshots.png", frames[::3][:6], spacing(frames[0]))
    summary.write()


if __name__ == "__main__":
    main(sys.argv[1])
