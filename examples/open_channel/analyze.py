#!/usr/bin/env python3
"""Figures and pictures of the flow past a cylinder between an inlet and an outlet.   usage:
analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, geometry, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "Schaefer & Turek 1996"
DRAG_20 = 5.58    # 2D-1: 5.57 to 5.59
# 2D-2: largest cd 3.22 to 3.24 (it swings by 2 %), largest cl 0.99 to 1.01, St 0.295 to 0.305
DRAG_100, LIFT_100, STROUHAL = 3.23, 1.0, 0.30
D = 0.1
COLOURS = (plot.BLUE, plot.ORANGE, "#3a923a", plot.GREY)


def swing(time, lift, U):
    """Amplitude and frequency of the sine that fits best, between a third and twice the frequency
    of the reference"""
    lift = lift - lift.mean()
    best = (0.0, 0.0)
    for f in np.arange(STROUHAL / 3, 2 * STROUHAL, 0.002) * U / D:
        waves = np.column_stack([np.sin(2 * np.pi * f * time), np.cos(2 * np.pi * f * time)])
        best = max(best, (float(np.hypot(*np.linalg.lstsq(waves, lift, rcond=None)[0])), f))
    return best


def figures(folder):
    """Of the last half of a run: drag, lift, frequency and the balance of what came and left"""
    s = series.read(Path(folder) / "series.csv")
    U = float(log.read(Path(folder) / "log.lammps").values["speed"])
    late = s.time >= 0.5 * s.time[-1]
    scale = 2.0 / (1000.0 * U**2 * D)
    window = 0.2 * D / U
    found = {"drag": scale * s["drag"][late].mean()}
    found["lift"], frequency = swing(s.time[late], scale * s["lift"][late], U)
    found["strouhal"] = frequency * D / U
    found["in"], found["out"] = s["in"][late].mean(), s["out"][late].mean()
    found["particles"] = s["fluid"][late].mean() / s["fluid"][0]
    found["lost"] = s["fluid"][-1] - s["fluid"][0] - (s["came"][-1]
                                                      - s["came"][0]) + s["left"][-1] - s["left"][0]
    return found, s, scale, window


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    found, s, scale, window = figures(folder)
    slow = float(summary.log.values["speed"]) < 0.5
    summary.add("drag", found["drag"], "", DRAG_20 if slow else DRAG_100, SOURCE)
    summary.add("lift_amplitude", found["lift"], "", None if slow else LIFT_100, SOURCE)
    if not slow:
        summary.add("strouhal", found["strouhal"], "", STROUHAL, SOURCE)
    for name in ("in", "out", "particles", "lost"):
        summary.add(name, found[name])
    plot.lines(folder / "forces.png", "t [s]", "coefficient", [
        (s.time, series.smooth(s.time, scale * s[name], window), name, colour)
        for name, colour in zip(("drag", "lift"), COLOURS)])
    last = dump.read(folder / "particles.dump")[-1]
    last = last.of_types(1)
    dx = float(summary.log.values["dx"])
    spin = geometry.vorticity(*(last[name] for name in ("x", "y", "vx", "vy")), 2.5 * dx)
    plot.clouds(folder / "vorticity.png", [(f"t = {last.time:.2f} s", last["x"], last["y"], spin)],
                dx, ((last["x"].min(), last["x"].max()), (0, 0.41)), "vorticity [1/s]",
                (-40.0, 40.0), panel_width=8.0, colours="RdBu_r")
    return summary.write()


def study(folder, cases):
    """Figures of all cases, forces in one picture."""
    folder = Path(folder)
    summary = Summary(folder)
    curves = []
    for (name, path), colour in zip(cases.items(), COLOURS):
        found, s, scale, window = figures(path)
        summary.add(f"drag_{name}", found["drag"], "", DRAG_20 if "20" in name else DRAG_100,
                    SOURCE)
        summary.add(f"lift_amplitude_{name}", found["lift"], "", None if "20" in name else LIFT_100,
                    SOURCE)
        if "20" not in name:
            summary.add(f"strouhal_{name}", found["strouhal"], "", STROUHAL, SOURCE)
        for key in ("in", "out", "particles", "lost"):
            summary.add(f"{key}_{name}", found[key])
        curves.append((s.time, series.smooth(s.time, scale * s["lift"], window),
                       name.replace("_", " "), colour))
    plot.lines(folder / "lift.png", "t [s]", "lift coefficient", curves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
