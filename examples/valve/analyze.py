#!/usr/bin/env python3
"""Figures and pictures of the valve.   usage: analyze.py FOLDER

main reads valve.csv, particles.dump and log.lammps of one run and writes summary.json, valve.png
and snapshots.png beside them; study compares the runs of cases.json, each with that of the finest
water.
"""

import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER, LEAFLET, FOOT = 1, 2, 3
# [spacing of a leaflet] no point of a square of particles is farther from the nearest one
INSIDE = 0.5**0.5
CHANGE = 0.03  # target: of figures, from the last water but one to the finest
FIGURES = (("forward", 1e6, "mm^2", CHANGE), ("back", 1e6, "mm^2", None),
           ("opening", 1e3, "mm", CHANGE), ("closed", 1e3, "mm", None))
COLOURS = (plot.GREEN, plot.ORANGE, plot.BLUE)


def nearest(points, others):
    """Distance of each of `points` (n, 2) to the nearest of `others` (m, 2), without a matrix of
    more than a million entries."""
    step = max(1, 1_000_000 // max(1, len(others)))
    parts = [points[k:k + step] for k in range(0, len(points), step)]
    return np.concatenate([np.sqrt(((part[:, None] - others[None]) ** 2).sum(axis=2).min(axis=1))
                           for part in parts]) if parts else np.empty(0)


def distances(frame, values):
    """(water particles that may be in a leaflet, least distance of water to a leaflet's particles,
    that of the free ones of both leaflets).

    Distances are in spacings of a leaflet.
    """
    place, solid = frame.vector("xy"), np.isin(frame["type"], (LEAFLET, FOOT))
    water = place[(frame["type"] == WATER) & (place[:, 0] > 0.0)]
    reach = 2.0 * values["wx"]
    low, high = place[solid].min(axis=0) - reach, place[solid].max(axis=0) + reach
    apart = nearest(water[((water > low) & (water < high)).all(axis=1)],
                    place[solid]) / values["sx"]
    leaflets = [place[(frame["type"] == LEAFLET) & (frame["mol"] == k)] for k in (1, 2)]
    return int((apart < INSIDE).sum()), apart.min(), nearest(*leaflets).min() / values["sx"]


def pulses(valve, period):
    """Of each whole period: (volume forward, volume back, largest opening, least opening after it),
    in m^2 and m.

    A pulse begins where the volume that has passed is least between the largest ones of two
    periods, or at the start.
    """
    time, opening = valve.time, valve["highy"] - valve["lowy"]
    passed = np.concatenate(
        [[0.0], np.cumsum(0.5 * np.diff(time) * (valve["q"][1:] + valve["q"][:-1]))])
    count = int(time[-1] / period + 0.02)  # the last row may be a few steps before the end
    within = [np.flatnonzero((time >= k * period) & (time < (k + 1) * period))
              for k in range(count)]
    peaks = [rows[np.argmax(passed[rows])] for rows in within]
    found, start = [], 0
    for rows, peak, last in zip(within, peaks, [*peaks[1:], len(time) - 1]):
        end = peak + np.argmin(passed[peak:last + 1])
        widest = rows[np.argmax(opening[rows])]
        found.append((passed[peak] - passed[start], passed[peak] - passed[end], opening[widest],
                      opening[widest:last + 1].min()))
        start = end
    return found, passed


def read(folder):
    """(flow and tips over time, values of the log, frames, distances of each)"""
    valve, values = series.read(Path(folder) / "valve.csv"), log.read(Path(folder)
                                                                      / "log.lammps").values
    frames = dump.read(Path(folder) / "particles.dump")
    return valve, values, frames, [distances(frame, values) for frame in frames]


def add(summary, run, suffix="", finest=None):
    """Figures of one run; the pulses' are judged by those of the run with the finest water, if it
    is another one and is given."""
    valve, values, _, apart = run
    references = pulses(finest[0], values["period"])[0] if finest else []
    for k, figures in enumerate(pulses(valve, values["period"])[0]):
        expected = references[k] if k < len(references) else (None,) * len(FIGURES)
        for (name, scale, unit, target), value, other in zip(FIGURES, figures, expected):
            judged = (scale * other, "finest water", target) if other else ()
            summary.add(f"{name}_{k + 1}{suffix}", scale * value, unit, *judged)
    inside, water, leaflets = zip(*apart)
    summary.add(f"water_in_leaflets{suffix}", max(inside), "particles", target=0)
    summary.add(f"nearest_water{suffix}", min(water), "spacings of a leaflet")
    summary.add(f"nearest_leaflets{suffix}", min(leaflets), "spacings of a leaflet")
    summary.add(f"leaflets_in_each_other{suffix}", sum(d < INSIDE for d in leaflets), "frames",
                target=0)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    run = read(folder)
    add(summary, run)
    picture_valve(folder / "valve.png", [run])
    picture_snapshots(folder / "snapshots.png", run)
    return summary.write()


def picture_valve(path, runs):
    """Flow and opening over time."""
    with plot.picture(path, 8.4, 3.5) as figure:
        panels = figure.subplots(1, 2)
        for (valve, values, *_), colour in zip(runs, COLOURS):
            label = f"water at {1e3 * values['wx']:.2g} mm"
            panels[0].plot(valve.time, 1e4 * valve["q"], color=colour, label=label)
            panels[1].plot(valve.time, 1e3 * (valve["highy"] - valve["lowy"]), color=colour,
                           label=label)
        panels[0].axhline(0.0, color=plot.GREY, linewidth=0.8)
        for axes, label in zip(panels, ("flow [cm$^2$/s]", "distance of the tips [mm]")):
            axes.set(xlabel="time [s]", ylabel=label)
        panels[1].legend()
        figure.tight_layout()


def picture_snapshots(path, run):
    """The valve as it opens, open, and closed."""
    _, values, frames, _ = run
    shown = dump.nearest(frames, [share * values["period"] for share in (0.25, 0.5, 1.0)],
                         tolerance=values["period"])
    shown = [frame.select(frame["x"] > -values["wx"])
             for frame in {frame.time: frame for frame in shown}.values()]
    plot.snapshots(path, shown, values["wx"], fluid=(WATER,), solid=(LEAFLET, FOOT), columns=1,
                   panel_width=6.0)


def study(folder, cases):
    """The figures of all cases, and their curves."""
    folder = Path(folder)
    summary = Summary(folder)
    runs = sorted((read(path) for path in cases.values()), key=lambda run: -run[1]["wx"])
    for k, run in enumerate(runs):
        add(summary, run, f"_{run[1]['rows']:g}_rows", runs[-1] if k == len(runs) - 2 else None)
    picture_valve(folder / "valve.png", runs)
    picture_snapshots(folder / "snapshots.png", runs[-1])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
