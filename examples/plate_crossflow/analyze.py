#!/usr/bin/env python3
"""Figures and pictures of an elastic plate in cross-flow.   usage: analyze.py FOLDER

main reads series.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

# point A at 8 s: displacement along the stream and upward, twice that across
REFERENCE = {"ux": (14.63, 0.03), "uy": (5.0, None), "uz_twice": (-0.447, None)}  # mm, target
SOURCE = "code, Tukovic et al. 2018"
MEAN = 1.0  # [s] at the end, over which figures are taken
COLORS = {2: plot.GREY, 4: plot.ORANGE, 6: plot.BLUE}


def read(folder):
    """(values of the log, time, displacements of A [mm], force on half of the plate [N])"""
    s = series.read(Path(folder) / "series.csv")
    return log.read(Path(folder) / "log.lammps").values, s.time, {
        name: 1e3 * s[name] for name in ("ux", "uy", "uz")}, s["fx"]


def add(summary, folder, suffix="", judged=True):
    """The figures of one run; returns what it read."""
    values, time, u, force = read(folder)
    late = time >= time[-1] - MEAN
    found = {"ux": u["ux"][late].mean(), "uy": u["uy"][late].mean(),
             "uz_twice": 2 * u["uz"][late].mean()}
    for name, value in found.items():
        reference, target = REFERENCE[name]
        summary.add(name + suffix, value, "mm", reference, SOURCE, target if judged else None)
    summary.add("ux_drift" + suffix, (u["ux"][late][-1] - u["ux"][late][0]) / found["ux"],
                "of it, in the last second")
    summary.add("force" + suffix, force[late].mean(), "N, on one half")
    return values, time, u, force


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values, time, u, _ = add(summary, folder)
    plot.lines(folder / "displacement.png", "t [s]", "displacement of A [mm]", [
        (time, u["ux"], "along the stream", plot.BLUE), (time, u["uy"], "upward", plot.ORANGE)],
               levels=[(REFERENCE["ux"][0], SOURCE), (REFERENCE["uy"][0], "")])
    picture(folder / "snapshots.png", folder, values)
    return summary.write()


def picture(path, folder, values):
    """The slice next to the plane of symmetry, by the velocity along the stream."""
    last, dx = dump.read(Path(folder) / "particles.dump")[-1], values["dx"]
    solid = last["type"] > 1
    cut = (np.abs(last["z"]) < dx) & (last["y"] > -0.1)
    there = cut & ~solid
    plot.clouds(path, [(f"t = {last.time:.0f} s",
                        np.append(last["x"][there], last["x"][cut & solid]),
                        np.append(last["y"][there], last["y"][cut & solid]),
                        np.append(last["vx"][there], np.zeros((cut & solid).sum())))],
                dx, ((0.0, 1.5), (-0.05, 0.4)), "velocity along the stream [m/s]", panel_width=6.5,
                colours="RdBu_r", extent=(-0.5, 0.5))


def study(folder, cases):
    """Displacements at all resolutions."""
    folder = Path(folder)
    summary = Summary(folder)
    curves = []
    for name, path in cases.items():
        values, time, u, _ = add(summary, path, f"_{name}", name == list(cases)[-1])
        color = COLORS.get(int(values["across"]), "black")
        curves.append((time, u["ux"], f"{values['across']:g} particles through the plate", color))
        curves.append((time, u["uy"], None, color))
    with plot.picture(folder / "displacement.png", 6.4, 3.4) as figure:
        axes = figure.subplots()
        for time, value, label, color in curves:
            axes.plot(time, value, color=color, linewidth=1.1, label=label)
        for name, style in (("ux", "--"), ("uy", ":")):
            axes.axhline(
                REFERENCE[name][0], color="black", linestyle=style, linewidth=1.0,
                label=f"Tukovic et al. 2018, {'along the stream' if name == 'ux' else 'upward'}")
        axes.set(xlabel="t [s]", ylabel="displacement of A [mm]")
        axes.legend(fontsize=7)
        figure.tight_layout()
    finest = list(cases)[-1]
    picture(folder / "snapshots.png", cases[finest], read(cases[finest])[0])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
