#!/usr/bin/env python3
"""Figures and pictures of a block of mud that slumps.   usage: analyze.py FOLDER

main reads slump.csv, particles.dump and run.json of one run; study compares the runs of cases.json.
"""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import RUN_FILE, Summary  # noqa: E402

SIDE, YIELD, WEIGHT, M = 0.1, 50.0, 1000 * 9.81, 100.0
B = YIELD / WEIGHT
# of h = sqrt(2B(FRONT-x)), whose volume is that of the block; 5/2 of its mean x
FRONT = (9 * SIDE**4 / (8 * B))**(1 / 3)
ARREST = "theory, shallow layer at arrest"
CREEP = "finite differences, shallow layer, law with m"  # lubrication()
COLUMN = 0.02  # [m]


def settings(folder):
    """(spacing, K, end time) of a run"""
    given = json.loads((Path(folder) / RUN_FILE).read_text())["variables"]
    return tuple(float(given[name]) for name in ("dx", "K", "tend"))


def arrested(x):
    """Height of the layer at arrest"""
    return np.sqrt(2 * B * np.maximum(FRONT - x, 0))


def rates(stress, K):
    """Shear rates of the law with m, by bisection"""
    low, high = np.zeros_like(stress), np.full_like(stress, stress[-1] / K)
    for _ in range(60):
        middle = 0.5 * (low + high)
        less = K * middle - YIELD * np.expm1(-M * middle) < stress
        low, high = np.where(less, middle, low), np.where(less, high, middle)
    return 0.5 * (low + high)


def lubrication(K, time, dx=0.0025, largest=0.002):
    """Spread, 5/2 of the mean x, of a shallow layer with hydrostatic pressure and no inertia: the
    flux of height h and slope s is the integral of stress times rate over the stress from 0 to rho
    g h s, over (rho g s)^2. Finite volumes, implicit.
    """
    stress = np.concatenate([np.linspace(0, 4 * YIELD, 8001),
                             np.geomspace(4 * YIELD, 400 * YIELD, 4000)[1:]])
    power = stress * rates(stress, K)
    flux = np.concatenate([[0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(stress))])
    n = round(0.36 / dx)
    k, x = np.arange(n), (np.arange(n) + 0.5) * dx
    h, now, dt = np.where(x < SIDE, SIDE, 0.0), 0.0, 1e-5

    def conductance(h):
        slope, height = np.abs(np.diff(h)) / dx + 1e-9, 0.5 * (h[1:] + h[:-1])
        return np.interp(WEIGHT * slope * height, stress,
                         flux) / (WEIGHT * slope)**2 / slope / dx**2

    while now < time:
        step, new = min(dt, time - now), h
        for _ in range(2):
            g = step * conductance(0.5 * (h + new))
            matrix = np.eye(n)
            matrix[k[:-1], k[:-1]] += g
            matrix[k[1:], k[1:]] += g
            matrix[k[:-1], k[1:]] -= g
            matrix[k[1:], k[:-1]] -= g
            new = np.linalg.solve(matrix, h)
        h, now, dt = new, now + step, min(1.02 * dt, largest)
    return 2.5 * float(np.sum(h * x) / np.sum(h))


def profile(frame):
    """(middles of columns, height of what is in each), of particles of equal volume"""
    edges = np.arange(0.0, 0.4, COLUMN)
    counts, _ = np.histogram(frame["x"], edges)
    return 0.5 * (edges[1:] + edges[:-1]), counts * SIDE**2 / len(frame) / COLUMN


def add(summary, folder, suffix="", judged=True):
    """The figures of one run, each with the size of its error, which has the target"""
    _, K, tend = settings(folder)
    s, frame = series.read(Path(folder) / "slump.csv"), dump.read(Path(folder)
                                                                  / "particles.dump")[-1]
    found = [("front", s["front"][-1], FRONT, ARREST),
             ("height_at_wall", s["height"][-1], float(arrested(0.0)), ARREST),
             ("spread", 2.5 * s["middle"][-1], FRONT, ARREST)]
    for time in (2.0, tend):
        found.append((f"spread_{time:g}_s", 2.5 * float(s.at("middle", min(time, s.time[-1]))),
                      lubrication(K, time), CREEP))
    for name, value, reference, source in found:
        summary.add(name + suffix, value, "m", reference, source)
        if judged:
            summary.add(f"error_of_{name}{suffix}", abs(value / reference - 1), "", None, None,
                        0.05 if name == "front" else None)
    x, h = profile(frame)
    error = np.mean(np.abs(h - arrested(x))[x < FRONT]) / arrested(0.0)
    summary.add("profile_error" + suffix, error, "of the height at the wall", None, None,
                0.05 if judged else None)


def draw(folder, run):
    """Viscosity at the end, a plug where it is high, and the profile of theory"""
    dx, *_ = settings(run)
    frame = dump.read(Path(run) / "particles.dump")[-1]
    colors = plot.matplotlib.colormaps["viridis"]
    share = (np.log10(frame["viscosity"]) - 2.5) / 1.3
    with plot.picture(Path(folder) / "slump.png", 5.2, 1.7) as figure:
        axes = figure.add_axes((0.14, 0.27, 0.68, 0.71))
        plot.field(axes, frame["x"], frame["y"], dx, colors(np.clip(share, 0, 1)),
                   ((0.0, 0.3), (0.0, 0.07)))
        x = np.linspace(0, FRONT, 300)
        axes.plot(x, arrested(x), color=plot.RED, label="theory, at arrest")
        axes.legend()
        axes.set(xlabel="x [m]", ylabel="y [m]")
        bar = plot.ScalarMappable(plot.Normalize(2.5, 3.8), colors)
        figure.colorbar(bar, cax=figure.add_axes((0.86, 0.27, 0.02, 0.66)),
                        label="log10 eta [Pa s]")


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    summary = Summary(folder)
    add(summary, folder)
    draw(folder, folder)
    return summary.write()


def study(folder, cases):
    """Figures of all cases; those of 20 and 30 rows are judged, the finest is shown."""
    summary = Summary(folder)
    for name, path in cases.items():
        add(summary, path, f"_{name}", name in ("20_rows", "30_rows"))
    draw(folder, cases["30_rows"])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
