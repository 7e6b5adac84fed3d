#!/usr/bin/env python3
"""Figures and pictures of the flow around a cylinder in a channel.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "Schaefer & Turek 1996, test case 2D-1: 5.57 to 5.59"
DRAG, LIFT = 5.58, 0.0107
UNSTEADY = "the same, 2D-2"  # Cd at its largest 3.22 to 3.24, Cl 0.99 to 1.01, St 0.295 to 0.305
DRAG_MAX, LIFT_MAX, STROUHAL = 3.23, 1.00, 0.300
DIAMETER = 0.1
COLOURS = ("#9ecae1", plot.BLUE, plot.ORANGE, plot.GREEN, plot.GREY)
SHOWN = 3  # periods


def forces(folder):
    """(mean velocity of the inflow, time, drag coefficient, lift coefficient)"""
    s = series.read(Path(folder) / "series.csv")
    speed = log.read(Path(folder) / "log.lammps").values["velocity"]
    factor = 2.0 / (1000.0 * speed**2 * DIAMETER)
    return speed, s.time, s["drag"] * factor, s["lift"] * factor


def coefficients(folder):
    """Means of drag and lift over the last quarter of the run, and their scatter (standard
    deviation)"""
    _, time, *both = forces(folder)
    drag, lift = (values[time >= 0.75 * time[-1]] for values in both)
    return drag.mean(), lift.mean(), drag.std(), lift.std()


def vortices(folder):
    """(largest drag, largest lift, Strouhal number) of the harmonics of the last five periods; the
    frequency is that of the lift's second half. Sound, whose frequencies are others, does not
    count."""
    speed, time, drag, lift = forces(folder)
    late = time >= 0.5 * time[-1]
    rate = series.frequency(time[late], series.smooth(time, lift, 0.5 * DIAMETER / speed)[late])
    return *(sum(series.swing(time, values, rate))
             for values in (drag, lift)), rate * DIAMETER / speed


def smoothed(time, values, speed):
    """Time in D/U and means of 0.2 D/U"""
    n = max(1, round(0.2 * DIAMETER / speed / (time[1] - time[0])))
    m = len(time) // n * n
    return time[:m].reshape(-1, n).mean(1) * speed / DIAMETER, values[:m].reshape(-1, n).mean(1)


def curve(folder):
    """Lift coefficient over the last periods, from a rise on"""
    speed, time, _, lift = forces(folder)
    rate = vortices(folder)[2] * speed / DIAMETER
    start = series.last_rise(time, lift, rate, SHOWN)
    inside = (time >= start) & (time <= start + SHOWN / rate)
    time, lift = smoothed(time[inside], lift[inside], speed)
    return time - start * speed / DIAMETER, lift


def named(case):
    """What a case of Re = 100 is called in the picture."""
    across, _, around = case.removeprefix("re_100_").partition("_to_")
    return f"{across} per diameter" + (f", {around} around the cylinder" if around
                                       else "") if case.startswith("re_100_") else case


def is_steady(folder):
    """2D-1 rather than 2D-2"""
    return forces(folder)[0] < 0.5


def add(summary, folder, suffix="", finest=False):
    """The figures of one run."""
    if is_steady(folder):
        drag, lift, scatter, lift_scatter = coefficients(folder)
        summary.add(f"drag{suffix}", drag, "", DRAG, SOURCE, 0.02 if finest else None)
        summary.add(f"lift{suffix}", lift, "", LIFT, "the same, 0.0104 to 0.0110")
        summary.add(f"drag_scatter{suffix}", scatter)
        summary.add(f"lift_scatter{suffix}", lift_scatter)
    else:
        for name, value, reference, target in zip(("drag_max", "lift_max", "strouhal"),
                                                  vortices(folder), (DRAG_MAX, LIFT_MAX, STROUHAL),
                                                  (0.015, 0.03, 0.01)):
            summary.add(name + suffix, value, "", reference, UNSTEADY, target if finest else None)


def draw(folder, cases):
    """lift.png of flows with vortices, the finest of them."""
    curves = [(*curve(path), named(label)) for label, path in cases.items() if not is_steady(path)]
    if curves:
        plot.lines(folder / "lift.png", "t U/D from a rise on, last periods",
                   "lift coefficient, means of 0.2 D/U",
                   [(*c, colour) for c, colour in zip(curves[-len(COLOURS):], COLOURS)],
                   levels=[(LIFT_MAX, "Schaefer and Turek, largest"), (-LIFT_MAX, "")])


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    add(summary, folder)
    draw(folder, {"SPH": folder})
    last = dump.read(folder / "particles.dump")[-1]
    last = last.of_types(1, 3, 4, 5)
    plot.clouds(folder / "speed.png", [(f"t = {last.time:.1f} s", last["x"], last["y"],
                                        np.hypot(last["vx"], last["vy"]))],
                summary.log.values["dx"], ((-0.3, 1.0), (0, 0.41)), "speed [m/s]", panel_width=8.0)
    return summary.write()


def study(folder, cases):
    """Figures of all cases; the lift of those with vortices in one picture."""
    folder = Path(folder)
    summary = Summary(folder)
    # they are in the order of resolution
    finest = {is_steady(path): name for name, path in cases.items()}
    for name, path in cases.items():
        add(summary, path, f"_{name}", name in finest.values())
    draw(folder, cases)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
