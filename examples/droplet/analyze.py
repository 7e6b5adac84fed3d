#!/usr/bin/env python3
"""Figures and pictures of the starter droplet.   usage: analyze.py FOLDER"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.animate import spacing  # noqa: E402
from fsi.summary import Summary  # noqa: E402

G, CONTACT = 9.81, 0.14  # [m/s^2], [s] the drop's lowest point falls for sqrt(2*0.1/g) = 0.143 s
SHOWN = (0.12, 0.15, 0.16, 0.17, 0.19, 0.22)  # [s]


def main(folder):
    """Reads height.csv, particles.dump and log.lammps; writes summary.json and snapshots.png."""
    summary, s = Summary(folder), series.read(Path(folder) / "height.csv")
    error = s["height"] - (s["height"][0] - 0.5 * G * s.time**2)
    summary.add("fall_error", float(np.abs(error[s.time < CONTACT]).max()), "m", target=1e-9)
    energy = summary.log.column("c_energy")
    summary.add("energy_error", float(np.abs(energy / energy[0] - 1.0).max()), target=2e-3)
    frames = dump.read(Path(folder) / "particles.dump")
    for frame in frames:
        frame.columns["speed"] = np.hypot(frame["vx"], frame["vy"])
    shown = dump.nearest(frames, SHOWN, 0.003) or frames[-1:]  # of a run that ends before
    plot.snapshots(Path(folder) / "snapshots.png", shown, spacing(frames[0]),
                   limits=((-0.25, 0.25), (0.0, 0.13)), colour="speed", columns=2,
                   panel_width=3.4, labels=None, night=True)
    summary.write()


if __name__ == "__main__":
    main(sys.argv[1])
