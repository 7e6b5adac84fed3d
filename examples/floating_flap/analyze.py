#!/usr/bin/env python3
"""Figures and pictures of a float with a flap below it in waves.   usage: analyze.py FOLDER

main reads series.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json with linear theory (theory.py).
"""

import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402
import theory  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WIDTH, HEIGHT, DRAFT, DEPTH, DENSITY, WATER = 0.22, 0.10, 0.06, 0.2, 600.0, 1000.0
CENTER = DEPTH - DRAFT + HEIGHT / 2  # of mass, above the bottom
SOURCE = "theory, linear potential flow (eigenfunction matching)"
HEAVE, PITCH, SAME, MOMENTUM = 0.05, 0.10, 0.01, 1e-10  # targets
SETTLED = 5.0  # periods after which amplitudes are taken
COLORS = (plot.GREY, plot.ORANGE, plot.BLUE)


def read(folder):
    """(values of the log, series)"""
    return log.read(Path(folder) / "log.lammps").values, series.read(Path(folder) / "series.csv")


def amplitude(time, values, period, after=SETTLED):
    """Complex amplitude of a sine of the period, beside a straight line."""
    late = time >= after * period if time[-1] > (after + 1) * period else time >= 0.5 * time[-1]
    t, omega = time[late], 2 * np.pi / period
    columns = np.column_stack([np.cos(omega * t), np.sin(omega * t), np.ones_like(t), t])
    a, b = np.linalg.lstsq(columns, values[late], rcond=None)[0][:2]
    return a + 1j * b


def expected(period):
    """(heave over the wave's amplitude, pitch over its slope, wave number) of the float without its
    flap"""
    mass, omega = WATER * WIDTH * DRAFT, 2 * np.pi / period
    inertia = DENSITY * WIDTH * HEIGHT * (WIDTH**2 + HEIGHT**2) / 12
    heave, pitch = theory.response(omega, WIDTH, DEPTH, DRAFT, WATER, mass, inertia, CENTER, CENTER)
    return abs(heave), abs(pitch), theory.wave_number(omega, DEPTH)


def apart(one, other, name):
    """Largest difference of two runs over the swing of the other, at the times of the first."""
    inside = one.time <= other.time[-1]
    return (np.abs(one[name][inside] - np.interp(one.time[inside], other.time, other[name])).max()
            / np.ptp(other[name]))


def balance(s, values):
    """(momentum unaccounted for over the impulse of the water's weight, energy gained or lost over
    the kick's kinetic energy)"""
    weight = WATER * 9.81 * DEPTH * 5.0 * s.time[-1]
    return s["lost"].max() / weight, np.abs(s["total"] - s["total"][0]).max() / s["kinetic"][0]


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    values, s = read(folder)
    summary = Summary(folder)
    summary.add("heave_largest", 1e3 * np.abs(s["heave"]).max(), "mm")
    summary.add("pitch_largest", np.degrees(np.abs(s["pitch"]).max()), "degrees")
    if values["flaps"]:
        summary.add("tip_largest", 1e3 * np.abs(s["tip"]).max(), "mm")
    if s["kinetic"][0] > 0.0:
        momentum, energy = balance(s, values)
        summary.add("momentum_unaccounted", momentum, target=MOMENTUM)
        summary.add("energy_error", energy, "of the kick's")
    plot.lines(folder / "heave.png", "t [s]", "heave [mm]",
               [(s.time, 1e3 * s["heave"], f"{1e3 * values['dx']:g} mm", plot.BLUE)])
    frames = dump.read(folder / "particles.dump")
    plot.snapshots(folder / "snapshots.png", frames[-4:], values["dx"], fluid=(1,), solid=(3, 4),
                   wall=(2,), limits=((1.4, 2.7), (0.0, 0.3)), columns=2, panel_width=4.2)
    return summary.write()


def study(folder, cases):
    """Heave and pitch in waves against linear theory; sub-steps against none."""
    folder = Path(folder)
    summary = Summary(folder)
    if "flap_10" in cases:
        shutil.copyfile(Path(cases["flap_10"]) / "snapshots.png", folder / "snapshots.png")
    runs = {name: read(path) for name, path in cases.items()}
    waves = {values["dx"]: abs(amplitude(s.time, s["level2"], values["T"]))
             for name, (values, s) in runs.items() if name.startswith("waves")}
    for dx, height in waves.items():
        summary.add(f"waves_{round(0.2 / dx)}", 1e3 * height, "mm", 10.0,
                    "theory of the piston, Biesel & Suquet 1951")
    for name, (values, s) in runs.items():
        if not name.startswith(("box", "flap")):
            continue
        period, dx = values["T"], values["dx"]
        heave, pitch, k = expected(period)
        # in long waves and where no run has the waves alone: those of the piston's theory
        wave = waves[dx] if period == 1.0 and dx in waves else 0.01
        box = name.startswith("box")
        found = [abs(amplitude(s.time, s[which], period)) / scale
                 for which, scale in (("heave", wave), ("pitch", k * wave))]
        judged = name == next((n for n in ("box_20", "box_10") if n in runs), None)
        summary.add(f"heave_{name}", found[0], "of the waves", heave if box else None,
                    SOURCE if box else None, HEAVE if judged else None)
        summary.add(f"pitch_{name}", found[1], "of their slope", pitch if box else None,
                    SOURCE if box else None, PITCH if judged else None)
        if not box:
            summary.add(f"tip_{name}", 1e3 * abs(amplitude(s.time, s["tip"], period)), "mm")
    if "kick" in runs:
        momentum, energy = balance(runs["kick"][1], runs["kick"][0])
        summary.add("momentum_unaccounted", momentum)
        summary.add("energy_error", energy, "of the kick's")
    if "kick_fine" in runs:
        summary.add("energy_error_fine", balance(runs["kick_fine"][1], runs["kick_fine"][0])[1],
                    "of the kick's", target=0.01)
    if "kick_short_no_substeps" in runs:
        slow = runs["kick_short_no_substeps"][1]
        seconds = {name: sum(run.cpu_seconds for run in log.read(Path(path) / "log.lammps").runs)
                   for name, path in cases.items()}
        for name in ("kick_short", "kick_short_half"):
            found = {which: apart(runs[name][1], slow, which)
                     for which in ("heave", "pitch", "tip")}
            for which, value in found.items():
                summary.add(f"apart_{which}_{name}", value, "of the swing")
            if name.endswith("half"):
                summary.add("apart_of_the_float", max(found["heave"], found["pitch"]),
                            "of the swing", target=SAME)
            summary.add(f"times_faster_{name}", seconds["kick_short_no_substeps"] / seconds[name])
    draw(folder, runs)
    return summary.write()


def draw(folder, runs):
    """Heave and pitch over time, and over the period with theory."""
    with plot.picture(folder / "waves.png", 9.0, 3.4) as figure:
        left, right = figure.subplots(1, 2)
        for kind, color in (("box", plot.GREY), ("flap", plot.BLUE)):
            finest = [name for name in (f"{kind}_20", f"{kind}_10") if name in runs][:1]
            for name in finest:
                s = runs[name][1]
                left.plot(s.time, 1e3 * s["heave"], color=color, linewidth=1.0,
                          label="heave [mm], "
                          f"{'float alone' if 'box' in name else 'with its flap'}")
                left.plot(s.time, np.degrees(s["pitch"]), color=color, linewidth=0.8,
                          linestyle="--", label="pitch [degrees]")
        left.set(xlabel="t [s]")
        periods = np.linspace(0.75, 2.0, 26)
        heave, pitch, _ = np.array([expected(T) for T in periods]).T
        right.plot(periods, heave, color=plot.BLUE, label="heave over the waves, linear theory")
        right.plot(periods, pitch, color=plot.ORANGE, label="pitch over their slope")
        for name, (values, s) in runs.items():
            if name.startswith("box"):
                wave = next((abs(amplitude(w.time, w["level2"], 1.0))
                             for other, (v, w) in runs.items()
                             if other.startswith("waves") and v["dx"] == values["dx"]),
                            0.01) if values["T"] == 1.0 else 0.01
                k = expected(values["T"])[2]
                for which, scale, color in (("heave", wave, plot.BLUE),
                                            ("pitch", k * wave, plot.ORANGE)):
                    right.plot(values["T"], abs(amplitude(s.time, s[which], values["T"])) / scale,
                               "o" if values["dx"] < 0.015 else "s", color=color, markersize=5)
        right.set(xlabel="period of the waves [s]", ylim=(0, 4))
        for axes in (left, right):
            axes.legend(fontsize=7)
        figure.tight_layout()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
