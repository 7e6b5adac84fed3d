#!/usr/bin/env python3
"""Figures and pictures of the lid-driven cavity.   usage: analyze.py FOLDER

main(folder) reads particles.dump and log.lammps of one run; study(folder, cases) compares runs.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "Ghia, Ghia & Shin 1982"
TARGETS = {100: 0.02, 400: None, 1000: 0.04}  # RMS over both lines, in units of the lid's speed
SETTLED = {100: 10.0, 400: 20.0, 1000: 40.0}  # [L/U] before which the flow is still on its way
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREEN)


def ghia(reynolds):
    """{"u": (y, u), "v": (x, v)} of the published tables, without the walls, and without the
    misprint of Re = 400, v(0.9063)."""
    found = {}
    for name in "uv":
        table = series.read(HERE / f"ghia_{name}.csv")
        s, values = table.time, table[f"Re{reynolds}"]
        keep = (s > 0.0) & (s < 1.0) & ~((reynolds == 400) & (name == "v") & (s == 0.9063))
        found[name] = s[keep], values[keep]
    return found


def mean_velocity(frames, points, dx):
    """Mean velocity at points (n, 2): a plane fitted to the particles of all frames within 1.5
    dx."""
    x, v = (np.concatenate([np.column_stack([frame[a], frame[b]]) for frame in frames])
            for a, b in (("x", "y"), ("vx", "vy")))
    found = []
    for point in points:
        offset = (x - point) / (1.5 * dx)
        near = (offset**2).sum(1) < 1.0
        root = (1.0 - (offset[near] ** 2).sum(1))[:, None]  # of the weight
        plane = np.column_stack([np.ones(near.sum()), offset[near]]) * root
        found.append(np.linalg.lstsq(plane, v[near] * root, rcond=None)[0][0])
    return np.array(found)


def lines(folder, reynolds, dx):
    """u along x = 1/2 and v along y = 1/2 at the published points, means over the last quarter of
    the run; both as curves; the frames."""
    frames = dump.read(Path(folder) / "particles.dump")
    frames = [frame for frame in frames if frame.time > 0.75 * frames[-1].time]
    points = ghia(reynolds)
    u = mean_velocity(frames, [(0.5, y) for y in points["u"][0]], dx)[:, 0]
    v = mean_velocity(frames, [(x, 0.5) for x in points["v"][0]], dx)[:, 1]
    along = np.linspace(dx, 1.0 - dx, 60)
    half = np.full(60, 0.5)
    curves = {"u": (along, mean_velocity(frames, np.column_stack([half, along]), dx)[:, 0]),
              "v": (along, mean_velocity(frames, np.column_stack([along, half]), dx)[:, 1])}
    return {"u": u, "v": v}, curves, frames


def measure(folder):
    """(Reynolds number, values of the log, lines, curves, RMS distance from the published tables,
    frames)."""
    values = log.read(Path(folder) / "log.lammps").values
    reynolds = round(values["Re"])
    found, curves, frames = lines(folder, reynolds, values["dx"])
    distance = np.concatenate([found[name] - ghia(reynolds)[name][1] for name in "uv"])
    return reynolds, values, found, curves, float(np.sqrt(np.mean(distance**2))), frames


def picture(path, runs):
    """Both lines. runs: [(Reynolds number, curves, label, colour)]; published points of each
    Reynolds number."""
    with plot.picture(path, 7.6, 3.6) as figure:
        for axes, name, labels in zip(figure.subplots(1, 2), "uv",
                                      (("u/U at x = L/2", "y/L"), ("x/L", "v/U at y = L/2"))):
            for reynolds in {run[0]: None for run in runs}:
                s, values = ghia(reynolds)[name]
                axes.plot(*((values, s) if name == "u" else (s, values)), "o", markersize=4.0,
                          markerfacecolor="white", color=plot.GREY,
                          label=SOURCE if reynolds == runs[0][0] else None)
            for _, curves, label, colour in runs:
                s, values = curves[name]
                axes.plot(*((values, s) if name == "u" else (s, values)), color=colour, label=label)
            axes.set(xlabel=labels[0], ylabel=labels[1])
        figure.legend(*axes.get_legend_handles_labels(), ncols=4, loc="upper center",
                      fontsize="small")
        figure.tight_layout(rect=(0, 0, 1, 0.93))


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    reynolds, values, found, curves, rms, frames = measure(folder)
    settled = frames[-1].time >= SETTLED[reynolds]
    summary.add("rms", rms, "U", target=TARGETS[reynolds] if settled else None)
    low, y = ghia(reynolds)["u"]
    summary.add("u_min", found["u"].min(), "U", y.min(), SOURCE)
    picture(folder / "lines.png",
            [(reynolds, curves, f"SPH, {values['n']:.0f} along a side", plot.BLUE)])
    last = frames[-1]
    plot.clouds(folder / "speed.png", [(f"Re = {reynolds}, t = {last.time:.0f} L/U", last["x"],
                                        last["y"], np.hypot(last["vx"], last["vy"]))],
                values["dx"], ((0, 1), (0, 1)), "speed/U", axis_labels=("x/L", "y/L"),
                panel_width=4.0)
    return summary.write()


def study(folder, cases):
    """The RMS of all cases; both lines at the finest resolution of each Reynolds number."""
    folder = Path(folder)
    summary = Summary(folder)
    finest = {}
    for name, path in cases.items():
        reynolds, values, _, curves, rms, _ = measure(path)
        summary.add(f"rms_{name}", rms, "U")
        if reynolds not in finest or values["n"] > finest[reynolds][0]:
            finest[reynolds] = values["n"], curves, rms
    for reynolds, (_, _, rms) in finest.items():
        summary.add(f"rms_{reynolds}", rms, "U", target=TARGETS[reynolds])
    picture(folder / "lines.png",
            [(reynolds, curves, f"Re = {reynolds}, {n:.0f} along a side", colour)
             for (reynolds, (n, curves, _)), colour in zip(sorted(finest.items()), COLOURS)])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
