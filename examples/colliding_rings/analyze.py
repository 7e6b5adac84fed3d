#!/usr/bin/env python3
"""Figures and pictures of the colliding rings.   usage: analyze.py FOLDER

main reads rings.csv, particles.dump and log.lammps of one run and writes summary.json, speed.png
and rings.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SNAPSHOTS = (0.0, 0.25, 0.5, 0.75)  # of the length of the run
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREY)


class Lattice:
    """Who is whose neighbour and mirror image, from the lattice of the first frame."""

    def __init__(self, first, spacing):
        self.spacing = spacing
        cell = np.round(first.vector() / spacing - 0.5).astype(int)
        at = {(i, j): k for k, (i, j) in enumerate(cell)}
        ring = first["type"]
        # cell i covers [i, i+1] spacings: its mirror image is -1-i
        self.mirror_x = np.array([at[-1 - i, j] for i, j in cell])
        self.mirror_y = np.array([at[i, -1 - j] for i, j in cell])
        pairs = [(k, at[i + a, j + b]) for k, (i, j) in enumerate(cell) for a, b in ((1, 0), (0, 1))
                 if (i + a, j + b) in at]
        self.pairs = np.array([(k, n) for k, n in pairs if ring[k] == ring[n]])

    def asymmetry(self, frame):
        """Largest distance of a particle from its partner's mirror image, over both mirror planes,
        in spacings."""
        x = frame.vector()
        return max(np.abs(x - x[self.mirror_x] * (-1.0, 1.0)).max(),
                   np.abs(x - x[self.mirror_y] * (1.0, -1.0)).max()) / self.spacing

    def stretch(self, frame):
        """Largest distance of two particles that were neighbours at the start, in spacings."""
        x = frame.vector()
        return float(np.sqrt(((x[self.pairs[:, 0]] - x[self.pairs[:, 1]]) ** 2).sum(axis=1)).max()
                     / self.spacing)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values = summary.log.values
    spacing = values["dx"]
    rings = series.read(folder / "rings.csv")
    frames = dump.read(folder / "particles.dump")
    lattice = Lattice(frames[0], spacing)

    start = rings["kinetic"][0]
    gap = max(abs(a + b) for a, b in zip(rings["v_left"], rings["v_right"])) / values["speed"]
    summary.add("rebound_speed", -rings["v_left"][-1] / values["speed"], "of the speed before")
    summary.add("largest_stretch", max(lattice.stretch(frame) for frame in frames), "dx",
                target=2.0)
    summary.add("min_pair_distance",
                min(min_pair_distance(frame.vector(), spacing) for frame in frames) / spacing, "dx")
    turn = rings.time[np.argmax(rings["v_left"] < 0.0)]
    asymmetry = {frame.time: lattice.asymmetry(frame) for frame in frames}
    summary.add("asymmetry_until_turn",
                max(value for time, value in asymmetry.items() if time <= turn), "dx", target=1e-6)
    summary.add("asymmetry", max(asymmetry.values()), "dx", target=1e-6)
    summary.add("momentum_error", gap, "of one ring's", target=1e-6)
    summary.add("energy_error", np.abs(rings["total"] / start - 1.0).max(), "of the kinetic energy",
                target=0.01)
    summary.add("energy_to_viscosity", rings["viscosity"][-1] / start, "of the kinetic energy")

    plot.lines(folder / "speed.png", "time [ms]", "speed of a ring over that at the start",
               [(1e3 * rings.time, rings["v_left"] / values["speed"], "left", plot.BLUE),
                (1e3 * rings.time, rings["v_right"] / values["speed"], "right", plot.ORANGE)])
    shown = dump.nearest(frames, [share * frames[-1].time for share in SNAPSHOTS],
                         tolerance=frames[-1].time)
    picture_rings(folder / "rings.png", shown, spacing)
    return summary.write()


def picture_rings(path, frames, spacing):
    """The rings, coloured by von Mises stress. Times are too short for the titles of
    plot.snapshots."""
    top = 1e-6 * np.percentile(np.concatenate([frame["vonmises"] for frame in frames]), 99.5)
    plot.clouds(path, [(f"t = {1e3 * f.time:.1f} ms", 1e2 * f["x"], 1e2 * f["y"],
                        1e-6 * f["vonmises"]) for f in frames], 1e2 * spacing,
                ((-12.5, 12.5), (-6.2, 6.2)), "von Mises stress [MPa]", (0.0, max(top, 1e-9)),
                ("x [cm]", "y [cm]"), 3.0, plot.SOLID_COLOURS, columns=2)


def study(folder, cases):
    """Speeds of the left ring in all cases; the figures of each with the case's name."""
    summary = Summary(folder)
    names = ("rebound_speed", "largest_stretch", "min_pair_distance", "asymmetry_until_turn",
             "asymmetry", "momentum_error", "energy_error")
    curves = []
    for (name, path), colour in zip(cases.items(), COLOURS):
        for figure in summary.cases[name]["figures"]:
            if figure["name"] in names:
                summary.add(f"{figure['name']}_{name}", figure["value"], figure["unit"],
                            target=figure["target"])
        rings = series.read(Path(path) / "rings.csv")
        curves.append((1e3 * rings.time, rings["v_left"] / rings["v_left"][0], name, colour))
    plot.lines(Path(folder) / "speed.png", "time [ms]",
               "speed of the left ring over that at the start", curves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
