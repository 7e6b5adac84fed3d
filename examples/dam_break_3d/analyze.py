#!/usr/bin/env python3
"""Figures and pictures of the dam break onto a box.   usage: analyze.py FOLDER

Reads history.csv, particles.dump and log.lammps in FOLDER, which tools/run makes; writes summary.json, gauges.png and
snapshots.png there.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SNAPSHOT_TIMES = (0.0, 0.4, 0.6, 0.9, 1.3, 1.8)  # [s]
STEADY = (3.0, 7.0)  # t sqrt(g/H): after the impact, before the wave comes back from the far wall
EXPERIMENT = "experiment, Kleefsman et al. 2005"
GAUGES = {1: plot.BLUE, 3: plot.ORANGE}
SLANT = (-0.30, 0.28)  # of the picture: what a metre across the tank is along and up


def mean(times, values, window):
    """Mean over a window, integrated linearly between the points given; None if they end before it does."""
    if times[-1] < window[1]:
        return None
    return float(np.mean(np.interp(np.linspace(*window, 401), times, values)))


def first_above(times, values, level):
    """First time at which the values pass a level, interpolated; None if they do not."""
    k = int(np.argmax(values > level))
    if not values[k] > level:
        return None
    return float(np.interp(level, values[k - 1:k + 1], times[k - 1:k + 1]) if k else times[0])


def count_leaks(frames, tank, log):
    """Number of water particles outside of the tank or in the box."""
    leaks = Leaks(0.5 * tank["dx"])
    m = leaks.margin
    for frame in frames:
        leaks.see(frame)
        leaks.beyond_walls(frame, [("x", 0.0, -1), ("x", tank["length"], 1), ("y", 0.0, -1), ("y", tank["half"], 1),
                                   ("z", 0.0, -1)])
        leaks.add(frame, (frame["x"] > tank["face"] + m) & (frame["x"] < tank["back"] - m)
                  & (frame["y"] < tank["side"] - m) & (frame["z"] < tank["top"] - m))
    return leaks.count(log)


def project(points):
    """Points (n, 3) in the plane of the picture: parallel projection, seen from above the near side wall."""
    return points[:, 0] + SLANT[0] * points[:, 1], points[:, 2] + SLANT[1] * points[:, 1]


def picture(path, frames, tank):
    """The whole tank at several times, both halves; water coloured by its speed, the box grey."""
    columns, rows = 3, -(-len(frames) // 3)
    speeds = [np.linalg.norm(f.vector(("vx", "vy", "vz")), axis=1) for f in frames]
    norm = Normalize(0.0, float(np.percentile(np.concatenate(speeds), 99.5)))
    a, b, s, h = (tank[k] for k in ("face", "back", "side", "top"))
    faces = [(((a, -s, 0), (a, s, 0), (a, s, h), (a, -s, h)), "#8c8c8c"),
             (((a, -s, h), (b, -s, h), (b, s, h), (a, s, h)), "#cfcfcf"),
             (((a, -s, 0), (b, -s, 0), (b, -s, h), (a, -s, h)), "#adadad")]
    w, length = tank["half"], tank["length"]
    floor = np.array([(0, -w, 0), (length, -w, 0), (length, w, 0), (0, w, 0), (0, -w, 0)])
    side = 1.2 * tank["dx"] * 3.0 * 72.0 / 4.0  # points: the panels are 3 inch and 4 m wide
    with plot.picture(path, 9.9, 0.55 + 1.3 * rows) as figure:
        axes = np.atleast_1d(figure.subplots(rows, columns)).ravel()
        for k, panel in enumerate(axes):
            panel.axis("off")
            panel.set(xlim=(-0.25, length + 0.25), ylim=(-0.2, 1.0), aspect="equal")
            if k >= len(frames):
                continue
            frame, speed = frames[k], speeds[k]
            points = np.concatenate([frame.vector(), frame.vector() * (1, -1, 1)])
            speed = np.concatenate([speed, speed])
            order = np.argsort(-points[:, 1] + 1e-3 * points[:, 2], kind="stable")  # from the far side to the near one
            points, speed = points[order], speed[order]
            behind = (points[:, 1] > s) | ((points[:, 0] > b) & (points[:, 1] > -s))
            panel.plot(*project(floor), color="#999999", linewidth=0.7, zorder=0)
            for which, level in ((behind, 1), (~behind, 3)):
                panel.scatter(*project(points[which]), s=side**2, c=speed[which], marker="s", linewidths=0, cmap="viridis",
                              norm=norm, zorder=level, rasterized=True)
            for corners, colour in faces:
                panel.fill(*project(np.array(corners)), color=colour, zorder=2)
            panel.set_title(f"t = {frame.time:.2f} s", loc="left", pad=-2)
        figure.subplots_adjust(left=0.01, right=0.91, bottom=0.01, top=0.93, wspace=0.02, hspace=0.12)
        bar = figure.add_axes((0.925, 0.15, 0.013, 0.7))
        figure.colorbar(ScalarMappable(norm, "viridis"), cax=bar, label="speed [m/s]", extend="max")


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    tank = summary.log.values
    history = series.read(folder / "history.csv")
    measured = series.read(HERE / "experiment.csv")
    times = history.time * np.sqrt(tank["g"] / tank["H"])

    curves, points = [], []
    for gauge, colour in GAUGES.items():
        mine = history[f"P{gauge}"]
        of_gauge = measured["gauge"] == gauge
        when, pressure = measured.time[of_gauge], measured["pressure"][of_gauge]
        summary.add(f"P{gauge}_arrival", first_above(times, mine, 0.3), "sqrt(H/g)", first_above(when, pressure, 0.3), EXPERIMENT)
        summary.add(f"P{gauge}_peak", float(mine.max()), "rho g H", float(pressure.max()), EXPERIMENT)
        summary.add(f"P{gauge}_steady", mean(times, mine, STEADY), "rho g H", mean(when, pressure, STEADY), EXPERIMENT)
        curves.append((times, mine, f"P{gauge}, this run", colour))
        points.append((when, pressure, f"P{gauge}, experiment", colour))
    plot.lines(folder / "gauges.png", "t sqrt(g/H)", "p/(rho g H) on the box", curves,
               [(when[when <= times[-1]], p[when <= times[-1]], label, colour) for when, p, label, colour in points])

    frames = dump.read(folder / "particles.dump")
    summary.add("particles_leaked", count_leaks(frames, tank, summary.log))
    picture(folder / "snapshots.png", dump.nearest(frames, SNAPSHOT_TIMES, tolerance=0.05), tank)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
