#!/usr/bin/env python3
"""Figures and pictures of a sphere in a stream.   usage: analyze.py FOLDER

main reads series.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "Clift, Grace & Weber 1978"
# {Reynolds number: figures} of spheres that shed vortices, which a half can and a quarter cannot
UNSTEADY = {300: {"drag": 0.656, "lift": 0.069, "strouhal": 0.137}}
UNSTEADY_SOURCE = "Johnson & Patel 1999"
DIAMETER = 0.1
COLORS = (plot.GREY, plot.BLUE, plot.ORANGE, plot.GREEN, plot.RED)
SHOWN = "16_levels_wide"  # in the picture of the speed
NOT_DRAWN = ("5_uniform", "8_levels", "re_300_8_levels")


def reference(re):
    """Drag coefficient of a sphere in free stream, Reynolds numbers from 20 to 260"""
    return 24 / re * (1 + 0.1935 * re**0.6305)


def published(re):
    """(drag coefficient, whose)"""
    return (UNSTEADY[re]["drag"], UNSTEADY_SOURCE) if re in UNSTEADY else (reference(re), SOURCE)


def read(folder):
    """(values of the log, time in D/U, coefficients by name)"""
    values = log.read(Path(folder) / "log.lammps").values
    s = series.read(Path(folder) / "series.csv")
    return values, s.time * values["velocity"] / DIAMETER, s


def add(summary, folder, suffix="", judged=True):
    """The figures of one run: means over its last fifth; of one that may shed vortices over its
    last two thirds, with lift and frequency."""
    values, time, s = read(folder)
    drag = s["drag"]
    sheds = values["Re"] in UNSTEADY and values["part"] != "quarter"
    late = time >= (1 / 3 if sheds else 0.8) * time[-1]
    half = time >= 0.5 * (time[late][0] + time[-1])
    summary.add("drag" + suffix, drag[late].mean(), "", *published(values["Re"]),
                0.03 if judged else None)
    if sheds:
        # without the sound of events, which is faster
        lift = series.smooth(time, s["lift"], 2.0)[late]
        rate = series.frequency(time[late], lift)
        of = UNSTEADY[values["Re"]]
        summary.add("strouhal" + suffix, rate, "", of["strouhal"], UNSTEADY_SOURCE,
                    0.03 if judged else None)
        summary.add("lift" + suffix, abs(lift.mean()), "", of["lift"], UNSTEADY_SOURCE)
        summary.add("lift_amplitude" + suffix, series.swing(time[late], s["lift"][late], rate)[1])
    elif judged:
        summary.add("drag_drift" + suffix, drag[half].mean() / drag[late & ~half].mean() - 1,
                    "between the halves of the last fifth")
        summary.add("drag_scatter" + suffix, drag[late].std())


def curve(folder):
    """Drag coefficient over time, means of 0.5 D/U"""
    _, time, s = read(folder)
    drag = s["drag"]
    edges = np.arange(0, time[-1] + 1e-9, 0.5)
    which = np.digitize(time, edges)
    kept = [k for k in range(1, len(edges)) if (which == k).any()]
    return np.array([time[which == k].mean() for k in kept]), np.array(
        [drag[which == k].mean() for k in kept])


def draw(folder, cases):
    cases = {name: path for name, path in cases.items() if name not in NOT_DRAWN}
    curves = [(*curve(path), name.replace("_", " "), color)
              for (name, path), color in zip(cases.items(), COLORS)]
    numbers = dict.fromkeys(read(path)[0]["Re"] for path in cases.values())
    levels = [(published(re)[0], f"{published(re)[1]}, Re = {re:g}") for re in numbers]
    plot.lines(folder / "drag.png", "t U/D", "drag coefficient, means of 0.5 D/U", curves,
               levels=levels)


def picture(path, folder):
    """The slice next to a plane of symmetry by the speed, that of a quarter mirrored in the other
    one: each particle as large as its level says."""
    values = read(folder)[0]
    last = dump.read(Path(folder) / "particles.dump")[-1]
    level = np.where(last["type"] == 1, 0,
                     np.where(last["type"] == 2, values["levels"], last["type"] - 2))
    dx = values["dx"] * 2 ** (-level / 3)
    cut = (last["z"] > 0) & (last["z"] < dx) & (last["type"] != 2)
    sides = 2 if values["part"] == "quarter" else 1
    x, y, dx = (np.tile(a[cut], sides) for a in (last["x"], last["y"], dx))
    y[cut.sum():] *= -1
    speed = np.tile(np.sqrt(last["vx"]**2 + last["vy"]**2 + last["vz"]**2)[cut],
                    sides) / values["velocity"]
    order = np.argsort(-dx)
    half = 0.5 * values["width"] * DIAMETER
    plot.clouds(path, [(f"t U/D = {last.time * values['velocity'] / DIAMETER:.0f}", x[order],
                        y[order], speed[order])], dx[order],
                ((x.min(), x.max()), (-half, half)), "speed over U", panel_width=6.5)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    add(summary, folder)
    draw(folder, {"SPH": folder})
    picture(folder / "speed.png", folder)
    return summary.write()


def study(folder, cases):
    """Figures of all cases."""
    folder = Path(folder)
    summary = Summary(folder)
    for name, path in cases.items():
        add(summary, path, f"_{name}", name != "5_uniform")
    draw(folder, cases)
    picture(folder / "speed.png", cases.get(SHOWN, list(cases.values())[-1]))
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
