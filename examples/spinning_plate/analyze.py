#!/usr/bin/env python3
"""Figures and pictures of the spinning plate.   usage: analyze.py FOLDER

main reads plate.csv, particles.dump and log.lammps of one run and writes summary.json, drift.png
and plate.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

COLOURS = (plot.BLUE, plot.ORANGE, plot.GREY)


def deviation(first, frame):
    """Largest distance of a particle from where the best rigid motion of the first frame has it."""
    a, b = (f.vector() - f.vector().mean(axis=0) for f in (first, frame))
    u, _, vt = np.linalg.svd(a.T @ b)
    flip = np.ones(a.shape[1])
    flip[-1] = np.sign(np.linalg.det(u @ vt))
    return float(np.sqrt(((a @ (u * flip) @ vt - b) ** 2).sum(axis=1)).max())


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values = summary.log.values
    plate = series.read(folder / "plate.csv")
    frames = dump.read(folder / "particles.dump")
    energy = (plate["kinetic"] + plate["strain"]) / plate["kinetic"][0]

    summary.add("angular_momentum_drift", np.abs(plate["spin"] / plate["spin"][0] - 1.0).max(),
                target=0.005)
    summary.add("energy_drift", np.abs(energy - 1.0).max(), target=0.005)
    summary.add("ledger_error", np.abs(plate["total"] / plate["total"][0] - 1.0).max())
    x, y = frames[0]["x"], frames[0]["y"]
    angle = np.unwrap([np.arctan2((x * f["y"] - y * f["x"]).sum(), (x * f["x"] + y * f["y"]).sum())
                       for f in frames])
    summary.add("turns", angle[-1] / (2.0 * np.pi))
    summary.add("rotation", angle[-1] / (values["omega"] * frames[-1].time), "of a rigid body's")
    off = [deviation(frames[0], frame) for frame in frames]
    summary.add("largest_deformation", max(off) / values["length"], "of the length")
    summary.add("last_deformation", off[-1] / values["length"], "of the length")

    picture_drift(folder / "drift.png", [(plate, "plate")])
    plot.snapshots(folder / "plate.png", dump.nearest(frames,
                                                      frames[-1].time * np.array((0.0, 0.43, 1.0)),
                                                      frames[-1].time), values["dx"],
                   fluid=(), solid=(1,), limits=((-0.2, 0.2), (-0.2, 0.2)))
    return summary.write()


def picture_drift(path, runs):
    """Relative changes of angular momentum (full) and energy (dashed). runs: [(plate, label)]."""
    with plot.picture(path) as figure:
        axes = figure.add_subplot()
        for (plate, label), colour in zip(runs, COLOURS):
            energy = (plate["kinetic"] + plate["strain"]) / plate["kinetic"][0]
            axes.plot(plate.time[1:], np.maximum(np.abs(plate["spin"] / plate["spin"][0] - 1.0)[1:],
                                                 1e-16), linewidth=1.0, color=colour,
                      label=f"{label}, angular momentum")
            axes.plot(plate.time[1:], np.maximum(np.abs(energy - 1.0)[1:], 1e-16), "--",
                      linewidth=1.0, color=colour, label=f"{label}, energy")
        axes.set_yscale("log")
        axes.set(xlabel="time [s]", ylabel="relative change")
        axes.legend(fontsize=7, loc="center right", bbox_to_anchor=(1.0, 0.4), frameon=True)
        figure.tight_layout()


def study(folder, cases):
    """All cases; the figures of each with the case's name."""
    summary = Summary(folder)
    names = ("angular_momentum_drift", "energy_drift", "largest_deformation", "last_deformation")
    for name in cases:
        for figure in summary.cases[name]["figures"]:
            if figure["name"] in names:
                summary.add(f"{figure['name']}_{name}", figure["value"], figure["unit"],
                            target=figure["target"])
    picture_drift(Path(folder) / "drift.png",
                  [(series.read(Path(path) / "plate.csv"), name) for name, path in cases.items()])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
