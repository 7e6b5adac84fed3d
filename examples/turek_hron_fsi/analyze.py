#!/usr/bin/env python3
"""Figures and pictures of the flag behind a cylinder.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump, run.json and log.lammps of one run; study(folder,
cases) compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, results, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "Turek & Hron 2006, Featflow level 4"
# mean, amplitude and frequency [Hz], or a steady value: displacements of A in mm, forces on
# cylinder and flag in N/m
REFERENCE = {
    "cfd1": {"drag": 14.29, "lift": 1.119},
    "cfd2": {"drag": 136.7, "lift": 10.53},
    "cfd3": {"drag": (439.45, 5.6183, 4.3956), "lift": (-11.893, 437.81, 4.3956)},
    "fsi1": {"ux": 0.0227, "uy": 0.8209, "drag": 14.295, "lift": 0.7638},
    "fsi2": {"ux": (-14.85, 12.70, 3.86), "uy": (1.30, 81.6, 1.93), "drag": (215.06, 77.65, 3.86),
             "lift": (0.61, 237.8, 1.93)},
    "fsi3": {"ux": (-2.88, 2.72, 10.93), "uy": (1.47, 34.99, 5.46), "drag": (460.5, 27.74, 10.93),
             "lift": (2.50, 153.91, 5.46)},
}
UNITS = {"ux": "mm", "uy": "mm", "drag": "N/m", "lift": "N/m"}
TARGETS = {("fsi1", "ux"): 0.05, ("fsi2", "ux_mean"): 0.05, ("fsi2", "ux_amplitude"): 0.05,
           ("fsi3", "ux_mean"): 0.05, ("fsi3", "ux_amplitude"): 0.05,
           ("fsi1", "uy"): 0.05, ("fsi1", "drag"): 0.03, ("cfd1", "drag"): 0.02,
           ("cfd2", "drag"): 0.02,
           ("fsi2", "uy_amplitude"): 0.03, ("fsi2", "frequency"): 0.02, ("fsi2", "drag_mean"): 0.03,
           ("fsi2", "drag_amplitude"): 0.08,
           ("fsi2", "lift_amplitude"): 0.08, ("fsi3", "uy_amplitude"): 0.04,
           ("fsi3", "frequency"): 0.02, ("fsi3", "drag_mean"): 0.03,
           ("fsi3", "drag_amplitude"): 0.1, ("fsi3", "lift_amplitude"): 0.1}
# figures are means over so many successive groups of the last periods: flags at Re = 200 swing
# unevenly
PERIODS, GROUPS = 3, 3
SHOWN = 2  # periods in the picture of the study
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREEN, plot.GREY)


def read(folder):
    """(case, values of the log, series with displacements in mm)."""
    found = log.read(Path(folder) / "log.lammps")
    s = series.read(Path(folder) / "series.csv")
    for name in ("ux", "uy"):
        s.columns[name] = 1e3 * s[name]
    return found.values["benchmark"], found.values, s


def swings(time, values, rate, groups=GROUPS):
    """(mean, amplitude) of the last `groups` of PERIODS periods, of as many as there are (groups,
    2)"""
    groups = [time <= time[-1] - k * PERIODS / rate for k in range(groups)]
    return np.array([series.swing(time[g], values[g], rate, PERIODS) for g in groups if g.any()
                     and (time[g][-1] - time[0]) * rate >= 1.0])


def grown(time, values, rate):
    """How many of the last groups do not belong to the growth of the swing: of each at least three
    quarters of the last one's amplitude"""
    amplitudes = swings(time, values, rate)[:, 1]
    small = amplitudes < 0.75 * amplitudes[0]
    return int(small.argmax()) if small.any() else GROUPS


def add(summary, folder, suffix="", finest=True):
    """The figures of one run, and the scatter of drag and lift about them."""
    case, _, s = read(folder)

    def figure(name, value, unit, reference):
        summary.add(name + suffix, value, unit, reference, SOURCE, TARGETS.get((case, name))
                    if finest else None)

    late = s.time >= 0.75 * s.time[-1]
    fundamental = "lift" if case == "cfd3" else "uy"
    steady = not isinstance(REFERENCE[case]["drag"], tuple)
    if steady:
        for name, reference in REFERENCE[case].items():
            figure(name, s[name][late].mean(), UNITS[name], reference)
    else:
        half = s.time >= 0.5 * s.time[-1]
        rate = series.frequency(s.time[half], s[fundamental][half])
        figure("frequency", rate, "Hz", REFERENCE[case][fundamental][2])
        groups = grown(s.time, s[fundamental], rate)
        for name, (mean, amplitude, _) in REFERENCE[case].items():
            found = swings(s.time, s[name], rate, groups)
            figure(f"{name}_mean", found[:, 0].mean(), UNITS[name], mean)
            figure(f"{name}_amplitude", found[:, 1].mean(), UNITS[name], amplitude)
            if name == fundamental:
                summary.add(f"{name}_amplitude_scatter{suffix}", found[:, 1].std(), UNITS[name])
    if steady:
        for name in ("drag", "lift"):
            summary.add(f"{name}_scatter{suffix}", s[name][late].std(), "N/m")
    summary.add(f"flow{suffix}", s["flow"][late].mean())


def picture(path, runs, case, names=("uy", "drag", "lift")):
    """Columns over time, one below the other, between the benchmark's mean less and plus its
    amplitude. runs: [(series, label)]."""
    panels, rate = [], 1.0
    for k, name in enumerate(names):
        reference = REFERENCE[case].get(name)
        mean, amplitude, rate = (*reference, rate)[:3] if isinstance(reference, tuple) else (
            reference, 0.0, rate)
        levels = sorted({mean - amplitude, mean + amplitude}) if reference else ()
        panels.append((f"{name} [{UNITS[name]}]",
                       [(s.time, s[name], label if k == 0 else None, colour)
                        for (s, label), colour in zip(runs, COLOURS)], (),
                       [(level, "Turek and Hron" if (k, n) == (0, 0) else "")
                        for n, level in enumerate(levels)]))
    # a tenth of the lift's period takes 2 % of its amplitude and, at twice the frequency, 6 % of
    # the drag's
    plot.noisy(path, "t [s]", panels, 0.1 / rate)


def picture_tip(path, runs):
    """The flag's tip over the last periods of runs, each on the benchmark's mean, amplitude and
    frequency as a sine; both rise through their means at t = 0. runs: {case: (series, label)}, a
    panel each.
    """
    with plot.picture(path, 7.6, 3.3) as figure:
        for axes, (case, (s, label)) in zip(np.ravel(figure.subplots(1, len(runs))), runs.items()):
            mean, amplitude, rate = REFERENCE[case]["uy"]
            half = s.time >= 0.5 * s.time[-1]
            found = series.frequency(s.time[half], s["uy"][half])
            start = series.last_rise(s.time, s["uy"], found, SHOWN)
            time = np.linspace(0.0, SHOWN / rate, 400)
            axes.plot(time, mean + amplitude * np.sin(2.0 * np.pi * rate * time), color=plot.ORANGE,
                      linewidth=4.5, alpha=0.55,
                      label="Featflow: mean, amplitude\nand frequency as a sine")
            axes.plot(time, s.at("uy", start + time), color=plot.BLUE, label=f"here, {label}")
            axes.set(xlabel="time [s]", title=case.upper(), xlim=(0.0, time[-1]),
                     ylim=(mean - 1.25 * amplitude, mean + 2.3 * amplitude))
            axes.legend(loc="upper left", fontsize=9.5, borderaxespad=0.2)
        figure.axes[0].set_ylabel("tip of the flag [mm]")
        figure.tight_layout()


def picture_speed(path, frame, case, spacing):
    """Speed of the water; the cylinder and the flag above it."""
    limits, width = ((0.0, 1.2), (0.0, 0.41)), 6.6
    height = width * 0.41 / 1.2
    # water of types 5 to 8 is finer
    levels = {1: spacing} | {4 + k: spacing * 2**(-0.5 * k) for k in range(1, 5)}
    waters = [(water, size) for water, size in ((frame.of_types(type), size)
                                                for type, size in levels.items()) if len(water)]
    flag = frame.of_types(3, 4)
    speed = [np.hypot(water["vx"], water["vy"]) for water, _ in waters]
    speeds = plot.Normalize(0.0, float(np.percentile(np.concatenate(speed), 99.5)))
    with plot.picture(path, width + 1.6, height + 0.75) as figure:
        whole = figure.get_size_inches()
        axes = figure.add_axes((0.62 / whole[0], 0.45 / whole[1], width / whole[0],
                                height / whole[1]))
        parts = [(water, size, plot.matplotlib.colormaps[plot.FLUID_COLOURS](speeds(v)))
                 for (water, size), v in zip(waters, speed)]
        parts += [(part, size, np.tile(plot.to_rgba(colour), (len(part), 1)))
                  for part, size, colour in ((frame.of_types(2), waters[-1][1], plot.WALL_COLOUR),
                                             (flag, dump.spacing(flag), plot.ORANGE))]
        for part, size, colours in parts:
            plot.field(axes, part["x"], part["y"], size, colours, limits)
        axes.set(xlabel="x [m]", ylabel="y [m]")
        axes.set_title(f"{case.upper()}, t = {frame.time:.2f} s", loc="left", pad=3)
        bar = figure.add_axes(((width + 0.75) / whole[0], 0.45 / whole[1], 0.12 / whole[0],
                               height / whole[1]))
        figure.colorbar(plot.ScalarMappable(speeds, plot.FLUID_COLOURS), cax=bar,
                        label="speed [m/s]", extend="max")


def label(name, values, ran):
    """Resolution and time of a case."""
    finer, near = (4, " near the flag") if "_to_" in name else (1, "")
    return (f"{round(0.1 * finer / values['dx'])} per diameter{near},\n"
            f"{results.duration(results.core_seconds(ran))} on one core")


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    add(summary, folder)
    case, values, s = read(folder)
    moves = case.startswith("fsi")
    picture(folder / "forces.png",
            [(s, f"{case.upper()}, {values['across']:.0f} particles through the flag")], case,
            ("uy", "drag", "lift") if moves else ("drag", "lift"))
    picture_speed(folder / "speed.png", dump.read(folder / "particles.dump")[-1], case,
                  values["dx"])
    return summary.write()


def study(folder, cases):
    """All cases; the tip of the flag in the finest runs of FSI2 and FSI3 on the benchmark's
    (tip.png)."""
    folder = Path(folder)
    summary = Summary(folder)
    # they are in the order of resolution
    finest = {read(path)[0]: name for name, path in cases.items()}
    for name, path in cases.items():
        add(summary, path, f"_{name}", name in finest.values())
    shown = {case: (read(cases[finest[case]])[2],
                    label(finest[case], read(cases[finest[case]])[1], summary.cases[finest[case]]))
             for case in ("fsi2", "fsi3") if case in finest}
    if shown:
        picture_tip(folder / "tip.png", shown)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
