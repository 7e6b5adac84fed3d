#!/usr/bin/env python3
"""Figures and pictures of Taylor-Green vortices.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.summary import Summary  # noqa: E402

EXACT = "exact solution of the Navier-Stokes equations (Taylor & Green 1937)"
K = 2.0 * np.pi
RATE = 2.0 * K**2 / 100.0  # of velocities at Re = 100, U = L = 1
LABELS = {"best": "shifting, shaken start", "lattice": "shifting, lattice",
          "lattice_strong": "shifting doubled, lattice",
          "plain": "no shifting, shaken start", "plain_lattice": "no shifting, lattice"}
COLOURS = (plot.BLUE, plot.ORANGE, "#3a923a", plot.GREY, "#b5b5b5")


def speed(frame):
    return np.hypot(frame["vx"], frame["vy"])


def exact_speed(frame):
    """|u| of the exact solution where the particles are."""
    x, y = K * frame["x"], K * frame["y"]
    return np.exp(-RATE * frame.time) * np.hypot(np.cos(x) * np.sin(y), np.sin(x) * np.cos(y))


def l1_error(frame):
    """sum ||u| - |u_exact|| / sum |u_exact| over the particles."""
    exact = exact_speed(frame)
    return float(np.abs(speed(frame) - exact).sum() / exact.sum())


def history(folder):
    """Times and L1 errors of all frames but the first, which is exact."""
    return np.array([(frame.time, l1_error(frame))
                     for frame in dump.frames(Path(folder) / "particles.dump")][1:]).T


def energy_rate(energy):
    """Decay rate of the kinetic energy, from a straight line through its logarithm over the whole
    run."""
    return -float(np.polyfit(energy.time, np.log(energy["ke"]), 1)[0])


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    spacing = summary.log.values["dx"]
    frames = dump.read(folder / "particles.dump")
    errors = np.array([l1_error(frame) for frame in frames[1:]])
    energy = series.read(folder / "series.csv")

    summary.add("l1_velocity", errors.mean())
    summary.add("l1_velocity_worst", errors.max())
    summary.add("l1_velocity_end", errors[-1])
    summary.add("energy_decay_rate", energy_rate(energy), "U/L", 2.0 * RATE, EXACT)
    summary.add("min_pair_distance",
                min(min_pair_distance(f.vector("xy"), spacing) for f in frames[1:]) / spacing, "dx")

    plot.lines(folder / "error.png", "t U/L", "L1 error of the speed",
               [([f.time for f in frames[1:]], errors, "", plot.BLUE)])
    start = energy["ke"][0]
    plot.lines(folder / "energy.png", "t U/L", "kinetic energy over that at the start",
               [(energy.time, energy["ke"] / start, "SPH", plot.BLUE),
                (energy.time, np.exp(-2.0 * RATE * energy.time), "exact", plot.ORANGE)],
               log_scale=True)
    last = dump.nearest(frames, (0.3, 1.0), frames[-1].time)
    plot.clouds(folder / "speed.png",
                [(f"t = {f.time:.2f} L/U", f["x"], f["y"], speed(f)) for f in last], spacing,
                ((0, 1), (0, 1)), "speed / U", axis_labels=("x / L", "y / L"))
    return summary.write()


def study(folder, cases):
    """The error of all cases in one picture; the figures are those of the best one."""
    folder = Path(folder)
    summary = Summary(folder)
    errors = {name: history(path) for name, path in cases.items()}
    for name, (_, error) in errors.items():
        tail = "" if name == "best" else f"_{name}"
        summary.add(f"l1_velocity{tail}", error.mean(), target=0.03 if name == "best" else None)
        summary.add(f"l1_velocity_worst{tail}", error.max())
        summary.add(f"energy_decay_rate{tail}",
                    energy_rate(series.read(cases[name] / "series.csv")), "U/L", 2.0 * RATE, EXACT)
    label = lambda name: LABELS.get(name, name)
    plot.lines(folder / "error.png", "t U/L", "L1 error of the speed",
               [(*errors[name], label(name), colour) for name, colour in zip(errors, COLOURS)],
               log_scale=True)
    panels = []
    for name in ("best", "lattice", "plain_lattice"):
        if name in cases:
            frame = dump.nearest(dump.read(cases[name] / "particles.dump"), [0.3], 1.0)[0]
            panels.append((f"{label(name)}, t = {frame.time:.2f} L/U", frame["x"], frame["y"],
                           speed(frame)))
            spacing = 1.0 / np.sqrt(len(frame))
    if panels:
        plot.clouds(folder / "speed.png", panels, spacing, ((0, 1), (0, 1)), "speed / U",
                    (0.0, np.exp(-0.3 * RATE)),
                    ("x / L", "y / L"))
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
