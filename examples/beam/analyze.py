#!/usr/bin/env python3
"""Figures and pictures of the starter beam.   usage: analyze.py FOLDER"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.animate import spacing  # noqa: E402
from fsi.summary import Summary  # noqa: E402

# Slender beam in plane strain: (1.8751^2/2 pi) sqrt(E I/((1-nu^2) rho A))/L^2 with the material
# `plate`
E, NU, RHO, LENGTH, THICKNESS = 1.9984472e6, 0.39751553, 1000.0, 0.2, 0.02
FREQUENCY = 1.8751041**2 / (2.0 * np.pi * LENGTH**2) * np.sqrt(E * THICKNESS**2
                                                               / (12.0 * (1.0 - NU**2) * RHO))


def main(folder):
    """Reads tip.csv, particles.dump and log.lammps; writes summary.json, tip.png and
    snapshots.png."""
    summary, s = Summary(folder), series.read(Path(folder) / "tip.csv")
    summary.add("frequency", series.frequency(s.time, s["tip"]), "Hz", FREQUENCY,
                "theory, slender beam in plane strain", target=0.03)
    energy = summary.log.column("c_energy")
    summary.add("energy_error", float(np.abs(energy / energy[0] - 1.0).max()), target=1e-3)
    plot.lines(Path(folder) / "tip.png", "t [s]", "tip [mm]",
               [(s.time, 1000.0 * s["tip"], "tip", plot.BLUE)])
    frames = dump.read(Path(folder) / "particles.dump")
    plot.snapshots(Path(folder) / "snapshots.png", frames[:3], spacing(frames[0]), fluid=(),
                   solid=(1,), limits=((-0.03, 0.22), (-0.04, 0.06)))
    summary.write()


if __name__ == "__main__":
    main(sys.argv[1])
