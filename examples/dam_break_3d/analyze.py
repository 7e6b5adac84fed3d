#!/usr/bin/env python3
"""Figures and pictures of the dam break onto a box.   usage: analyze.py FOLDER

main reads history.csv, peaks.csv, particles.dump and log.lammps in FOLDER, which tools/run makes,
and writes summary.json, gauges.png and snapshots.png there; study compares the peaks of the runs of
cases.json, of which the first is the page's.
"""

import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SNAPSHOT_TIMES = (0.0, 0.4, 0.6, 0.9, 1.3, 1.8)  # [s]
MEANS = (1, 2, 5)  # [ms]: the peak as gauges would see it that average over so long
STEADY = (3.0, 7.0)  # t sqrt(g/H): after the impact, before the wave comes back from the far wall
EXPERIMENT = "experiment, Kleefsman et al. 2005"
GAUGES = {1: plot.BLUE, 3: plot.ORANGE}
SLANT = (-0.30, 0.28)  # of the picture: what a metre across the tank is along and up


def mean(times, values, window):
    """Mean over a window, integrated linearly between the points given; None if they end before it
    does."""
    if times[-1] < window[1]:
        return None
    return float(np.mean(np.interp(np.linspace(*window, 401), times, values)))


def first_above(times, values, level):
    """First time at which the values pass a level, interpolated; None if they do not."""
    k = int(np.argmax(values > level))
    if not values[k] > level:
        return None
    return float(np.interp(level, values[k - 1:k + 1], times[k - 1:k + 1]) if k else times[0])


def largest_mean(times, values, width):
    """The largest mean over `width`, of values that are linear between the times given; windows
    begin at each and at twenty places between."""
    fine = np.unique(np.concatenate([times, np.linspace(times[0], times[-1], 20 * len(times))]))
    values = np.interp(fine, times, values)
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(fine))])
    ends = fine[fine <= fine[-1] - width] + width
    k = np.searchsorted(fine, ends, side="right") - 1
    until = whole[k] + 0.5 * (values[k] + np.interp(ends, fine, values)) * (ends - fine[k])
    return float((until - whole[:ends.size]).max() / width)


def add_peaks(summary, folder, suffix=""):
    """P1's largest value of all steps and its largest means."""
    history = series.read(Path(folder) / "peaks.csv")
    measured = series.read(HERE / "experiment.csv")
    reference = float(measured["pressure"][measured["gauge"] == 1].max()), EXPERIMENT
    summary.add(f"P1_sharpest{suffix}", float(history["P1"].max()), "rho g H", *reference)
    for width in MEANS:
        summary.add(f"P1_sharpest_{width}_ms{suffix}",
                    largest_mean(history.time, history["P1"], 1e-3 * width), "rho g H", *reference)


def count_leaks(frames, tank, log):
    """Number of water particles outside of the tank or in the box."""
    leaks = Leaks(0.5 * tank["dx"])
    m = leaks.margin
    for frame in frames:
        leaks.see(frame)
        leaks.beyond_walls(frame, [("x", 0.0, -1), ("x", tank["length"], 1), ("y", 0.0, -1),
                                   ("y", tank["half"], 1),
                                   ("z", 0.0, -1)])
        leaks.add(frame, (frame["x"] > tank["face"] + m) & (frame["x"] < tank["back"] - m)
                  & (frame["y"] < tank["side"] - m) & (frame["z"] < tank["top"] - m))
    return leaks.count(log)


def box(tank):
    """(points, brightness) of the box's front, top and near side."""
    step = 0.4 * tank["dx"]
    a, b, s, h = (tank[k] for k in ("face", "back", "side", "top"))
    x, y, z = (np.arange(low + 0.5 * step, high, step) for low, high in ((a, b), (-s, s), (0.0, h)))
    faces = [(np.meshgrid([a], y, z), 0.55), (np.meshgrid(x, y, [h]), 0.82),
             (np.meshgrid(x, [-s], z), 0.68)]
    return (np.concatenate([np.column_stack([c.ravel() for c in face]) for face, _ in faces]),
            np.repeat([light for _, light in faces], [face[0].size for face, _ in faces]))


def picture(path, frames, tank):
    """The whole tank at several times, both halves, in parallel projection from above the near side
    wall; water coloured by its speed, the box gray."""
    columns, rows = min(3, len(frames)), -(-len(frames) // 3)
    speeds = [np.linalg.norm(f.vector(("vx", "vy", "vz")), axis=1) for f in frames]
    norm = Normalize(0.0, float(np.percentile(np.concatenate(speeds), 99.5)))
    block, light = box(tank)
    limits = (-0.25, tank["length"] + 0.25), (-0.3, 1.0)
    width, height = 3.0, 3.0 * 1.3 / (tank["length"] + 0.5)
    whole = columns * width + 0.9, rows * (height + 0.2)
    with plot.picture(path, *whole) as figure:
        for k, (frame, speed) in enumerate(zip(frames, speeds)):
            row, column = divmod(k, columns)
            axes = figure.add_axes((column * width / whole[0], (rows - 1 - row) * (height + 0.2)
                                    / whole[1], width / whole[0], height / whole[1]))
            points = np.concatenate([frame.vector(), frame.vector() * (1, -1, 1), block])
            colours = np.concatenate([*2 * [plot.matplotlib.colormaps["viridis"](norm(speed))],
                                      np.repeat(light[:, None], 3, 1) @ np.eye(3, 4)
                                      + (0, 0, 0, 1)])
            size = np.repeat([tank["dx"], 0.5 * tank["dx"]], [2 * len(speed), len(light)])
            plot.field(axes, points[:, 0] + SLANT[0] * points[:, 1],
                       points[:, 2] + SLANT[1] * points[:, 1], size, colours, limits, -points[:, 1])
            axes.axis("off")
            axes.set_title(f"t = {frame.time:.2f} s", loc="left", pad=-2)
        bar = figure.add_axes((columns * width / whole[0] + 0.01, 0.15, 0.013, 0.7))
        figure.colorbar(ScalarMappable(norm, "viridis"), cax=bar, label="speed [m/s]", extend="max")


def add(summary, folder):
    """Figures of both gauges in one run and their picture."""
    tank = log.read(folder / "log.lammps").values
    history = series.read(folder / "history.csv")
    measured = series.read(HERE / "experiment.csv")
    times = history.time * np.sqrt(tank["g"] / tank["H"])

    panels = []
    for gauge, colour in GAUGES.items():
        mine = history[f"P{gauge}"]
        of_gauge = measured["gauge"] == gauge
        when, pressure = measured.time[of_gauge], measured["pressure"][of_gauge]
        summary.add(f"P{gauge}_arrival", first_above(times, mine, 0.3), "sqrt(H/g)",
                    first_above(when, pressure, 0.3), EXPERIMENT)
        summary.add(f"P{gauge}_peak", float(mine.max()), "rho g H", float(pressure.max()),
                    EXPERIMENT)
        summary.add(f"P{gauge}_steady", mean(times, mine, STEADY), "rho g H",
                    mean(when, pressure, STEADY), EXPERIMENT)
        shown = when <= times[-1]
        panels.append((f"p/(rho g H) at P{gauge}", [(times, mine, "computed", colour)],
                       [(when[shown], pressure[shown], "experiment", plot.GREY)], ()))
    plot.noisy(summary.folder / "gauges.png", "t sqrt(g/H)", panels, 0.2)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    add(summary, folder)
    add_peaks(summary, folder)
    frames = dump.read(folder / "particles.dump")
    summary.add("particles_leaked", count_leaks(frames, summary.log.values, summary.log))
    picture(folder / "snapshots.png", dump.nearest(frames, SNAPSHOT_TIMES, tolerance=0.05),
            summary.log.values)
    return summary.write()


def study(folder, cases):
    """The first case, and how sharp the peak at P1 is in all."""
    folder = Path(folder)
    summary = Summary(folder)
    first = next(iter(cases))
    add(summary, cases[first])
    for name, path in cases.items():
        add_peaks(summary, path, f"_{name}")
    summary.add("particles_leaked", next(figure["value"]
                                         for figure in summary.cases[first]["figures"]
                                         if figure["name"] == "particles_leaked"))
    shutil.copyfile(cases[first] / "snapshots.png", folder / "snapshots.png")
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
