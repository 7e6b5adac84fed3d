#!/usr/bin/env python3
"""Figures and pictures of the standing wave.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

LINEAR = "linear theory, omega^2 = g k tanh kd"
DAMPING = "linear theory, 4 nu k^2 (Lamb 1932, art. 348)"
# kinematic [m^2/s], as in potentials/materials.fsi
VISCOSITY = {"wave_viscous": 0.002, "water_inviscid": 0.0}
LABELS = {"viscous": "nu = 0.002 m$^2$/s", "inviscid": "inviscid"}


def oscillation(wave):
    """Period [s] and energy decay rate [1/s] of the mode: its zeros, and the largest values between
    them."""
    time, mode = wave.time, wave["mode"]
    before = np.nonzero(mode[:-1] * mode[1:] < 0.0)[0]
    zeros = time[before] - mode[before] * (time[before + 1]
                                           - time[before]) / (mode[before + 1] - mode[before])
    peaks = [(time[0], mode[0])]
    for first, last in zip(before[:-1], before[1:]):
        k = first + int(np.argmax(np.abs(mode[first:last])))
        peaks.append((time[k], abs(mode[k])))
    times, values = np.array(peaks).T
    rate = -2.0 * float(np.polyfit(times, np.log(values), 1)[0]) if len(peaks) > 2 else None
    return 2.0 * float(np.diff(zeros).mean()), rate


def theory(values):
    """Period [s] and energy decay rate [1/s]."""
    return (2.0 * np.pi / values["omega"], 4.0 * VISCOSITY[values["material"]]
            * values["wavenumber"] ** 2)


def expected(values, time):
    """Surface velocity at the wall over time."""
    return values["amplitude"] * values["omega"] * np.exp(-0.5 * theory(values)[1]
                                                          * time) * np.cos(values["omega"] * time)


def add_figures(summary, wave, values, tail=""):
    period, rate = oscillation(wave)
    true_period, true_rate = theory(values)
    summary.add(f"period{tail}", period, "s", true_period, LINEAR, target=0.01 if not tail
                else None)
    if rate is not None:
        summary.add(f"energy_decay_rate{tail}", rate, "1/s", true_rate or None, DAMPING if true_rate
                    else None)


def draw(path, waves):
    """Mode over time, theory as points; waves: list of (series, values, label)."""
    with plot.picture(path, 6.4, 3.6) as figure:
        axes = figure.add_subplot()
        for (wave, values, label), colour in zip(waves, (plot.BLUE, plot.ORANGE)):
            axes.plot(wave.time, wave["mode"], color=colour, label=f"SPH, {label}")
            few = slice(None, None, max(1, len(wave.time) // 50))
            axes.plot(wave.time[few], expected(values, wave.time[few]), "o", markersize=3.5,
                      markerfacecolor="white", color=colour,
                      label=f"linear theory, {label}")
        axes.set_xlabel("time [s]")
        axes.set_ylabel("surface velocity at the wall [m/s]")
        figure.legend(loc="upper center", ncols=2)
        figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.88))


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values, spacing = summary.log.values, summary.log.values["dx"]
    wave = series.read(folder / "series.csv")
    frames = dump.read(folder / "particles.dump")
    add_figures(summary, wave, values)
    leaks = Leaks(0.5 * spacing)
    for frame in frames:
        leaks.see(frame)
        leaks.beyond_walls(frame, [("x", 0.0, -1), ("x", values["width"], 1), ("y", 0.0, -1)])
    summary.add("particles_leaked", leaks.count(summary.log), target=0)
    draw(folder / "wave.png", [(wave, values, values["material"].replace("_", " "))])
    # a quarter of a period after the start the surface stands highest
    quarters = np.array([0.25, 0.75, 1.25]) * theory(values)[0]
    plot.snapshots(folder / "snapshots.png", dump.nearest(frames, quarters, quarters[0]), spacing)
    return summary.write()


def study(folder, cases):
    """The first case's figures are the scene's; the others' have its name behind theirs."""
    folder = Path(folder)
    summary = Summary(folder)
    waves = []
    for k, (name, path) in enumerate(cases.items()):
        wave, values = series.read(Path(path) / "series.csv"), log.read(Path(path)
                                                                        / "log.lammps").values
        add_figures(summary, wave, values, f"_{name}" if k else "")
        if name in LABELS:
            waves.append((wave, values, LABELS[name]))
    if waves:
        draw(folder / "wave.png", waves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
