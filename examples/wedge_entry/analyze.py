#!/usr/bin/env python3
"""Figures and pictures of a wedge that enters water.   usage: analyze.py FOLDER

main reads force.csv, load.dump, particles.dump and log.lammps of one run; study compares the runs
of cases.json.
"""

import sys
from functools import lru_cache
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))
sys.path.insert(0, str(HERE))

import numpy as np  # noqa: E402
import wagner  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER, RIGHT = 1, 2
RHO = 1000.0
SOURCE = "theory, Zhao & Faltinsen 1993"
EXPERIMENT = "experiment, Yettou et al. 2006"
BEAM, BENT_AT = "theory, Wagner's pressure on clamped beams", 1.97e-3  # [s]
# deadrise [degrees]: force over rho V^3 t, largest pressure over rho V^2/2, its height over V t
THEORY = {30: (14.139, 6.927, 0.4243), 40: (5.477, 3.266, 0.2866)}
FORCE, PEAK, SCATTER, VELOCITY, BENT = 0.03, 0.10, 0.10, 0.03, 0.10  # targets
# height over the still water [V t], in which the load on the face is collected
BINS = np.arange(-1.0, 1.0001, 0.05)
COLORS = (plot.GREY, plot.ORANGE, plot.BLUE)


def force(folder, values):
    """(time [s], force over rho V^3 t)"""
    s = series.read(folder / "force.csv")
    late = s.time > 0.0
    return s.time[late], s["force"][late] / (RHO * values["speed"] ** 3 * s.time[late])


def late_half(time):
    """From half of the time on: the flow is that of all times, larger, so that ever more particles
    make it up."""
    return time >= 0.5 * time[-1]


def profile(folder, values):
    """Pressure over rho V^2/2 in BINS: the load on the face's particles, the mean of the second
    half of the run."""
    slope, speed = np.radians(values["beta"]), values["speed"]
    frames = [frame for frame in dump.frames(folder / "load.dump") if frame.time > 0.0]
    load, count = np.zeros(len(BINS) - 1), 0
    for frame in frames:
        if frame.time < 0.5 * frames[-1].time:
            continue
        depth = speed * frame.time
        along = frame["x"] * np.cos(slope) + (frame["y"] + depth) * np.sin(slope)  # from the keel
        normal = frame["fy"] * np.cos(slope) - frame["fx"] * np.sin(slope)
        length = np.diff(BINS) * depth / np.sin(slope)
        load += np.histogram(along * np.sin(slope) / depth - 1.0, BINS, weights=normal)[0] / length
        count += 1
    return load / count / (0.5 * RHO * speed**2)


def peak(pressure):
    """(largest pressure, its height over V t), without the bins at the keel, where the other face
    has a share."""
    k = 3 + int(np.argmax(pressure[3:]))
    return pressure[k], 0.5 * (BINS[k] + BINS[k + 1])


def add_constant(summary, folder, values, suffix="", judged=True):
    """Force, its scatter, and largest pressure at constant speed."""
    wanted = THEORY.get(round(values["beta"]), (None, None, None))
    time, found = force(folder, values)
    late = found[late_half(time)]
    source = SOURCE if wanted[0] else None
    summary.add(f"force{suffix}", late.mean(), "rho V^3 t", wanted[0], source,
                FORCE if judged and source else None)
    summary.add(f"force_scatter{suffix}", late.std() / late.mean(), "of the mean",
                target=SCATTER if judged else None)
    pressure, height = peak(profile(folder, values))
    summary.add(f"peak_pressure{suffix}", pressure, "rho V^2/2", wanted[1], source,
                PEAK if judged and source else None)
    summary.add(f"peak_height{suffix}", height, "V t", wanted[2], source)


def add_free(summary, folder, suffix="", judged=True):
    """Velocity of the free body at the times of the experiment."""
    found = series.read(folder / "force.csv")
    for name, source, target in (("experiment", EXPERIMENT, VELOCITY if judged else None),
                                 ("code", None, None)):
        points = series.read(HERE / f"{name}.csv")
        inside = points.time <= found.time[-1] + 1e-3
        if not inside.any():
            continue
        times, measured = points.time[inside], points["velocity"][inside]
        error = found.at("velocity", np.clip(times, found.time[0], found.time[-1])) / measured - 1.0
        summary.add(f"velocity_error_{name}{suffix}", np.abs(error).max(), "",
                    0.0 if source else None, source, target)
        summary.add(f"velocity_rms_{name}{suffix}", np.sqrt(np.mean(error**2)))


@lru_cache
def expected():
    """(time [s], deflection of the middle of an elastic face [m]) by theory"""
    return wagner.deflection()[:2]


def add_elastic(summary, folder, suffix="", judged=True):
    """Deflection of the middle of an elastic face."""
    s, (time, theory) = series.read(folder / "force.csv"), expected()
    summary.add(f"deflection{suffix}", 1e3 * np.interp(BENT_AT, s.time, s["deflection"]), "mm",
                1e3 * np.interp(BENT_AT, time, theory), BEAM,
                BENT if judged else None)
    inside = s.time <= time[-1]
    apart = np.abs(s["deflection"][inside]
                   - np.interp(s.time[inside], time, theory)).max() / theory.max()
    summary.add(f"deflection_apart{suffix}", apart, "of the largest", target=BENT if judged
                else None)


def add(summary, folder, values, suffix="", judged=True):
    """The figures of one run."""
    if values["body"] == "free":
        add_free(summary, folder, suffix, judged)
    elif values["body"] == "elastic":
        add_elastic(summary, folder, suffix, judged)
    else:
        add_constant(summary, folder, values, suffix, judged)


def picture_water(folder, values):
    """The water at the wedge at three times."""
    frames = dump.read(folder / "particles.dump")
    end = frames[-1].time
    shown = dump.nearest(frames, (0.3 * end, 0.65 * end, end), end)
    size = {"free": 1.0, "elastic": 0.8}.get(values["body"], 0.45)
    # the colors are those of the water that is shown
    shown = [frame.select((frame["x"] < size) & (frame["y"] > -0.5 * size)) for frame in shown]
    plot.snapshots(folder / "snapshots.png", shown, values["dx"], (WATER, 4, 5),
                   limits=((0.0, size), (-0.5 * size, 0.4 * size)),
                   wall=(RIGHT, *[3] * (values["body"] == "elastic")))


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values = summary.log.values
    add(summary, folder, values)
    picture_water(folder, values)
    return summary.write()


def study(folder, cases):
    """Figures of all cases; targets are those of the finest ones. Forces, pressures and velocities
    in one picture."""
    folder = Path(folder)
    summary = Summary(folder)
    read = {name: log.read(Path(path) / "log.lammps").values for name, path in cases.items()}
    finest = {(v["body"], v["beta"]): name for name, v in read.items()
              if name.replace("_", "").isdigit() or v["body"] != "constant"}
    for name, path in cases.items():
        add(summary, Path(path), read[name], f"_{name}", name in finest.values())
    with plot.picture(folder / "curves.png", 13.0, 3.6) as figure:
        draw(figure.subplots(1, 4),
             {name: (Path(cases[name]), v) for name, v in read.items() if "_lattice" not in name})
        figure.tight_layout()
    return summary.write()


def draw(axes, cases):
    """Force over time, pressure over height, velocity of the free body."""
    middle = 0.5 * (BINS[1:] + BINS[:-1])
    constant = [(path, v) for name, (path, v) in cases.items() if name.replace("_", "").isdigit()]
    colors = {dx: color for dx, color in zip(sorted({v["dx"] for _, v in constant}, reverse=True),
                                             COLORS)}
    for path, v in constant:
        time, found = force(path, v)
        depth, label = v["speed"] * time, f"dx = {1e3 * v['dx']:.3g} mm" if round(
            v["beta"]) == 30 else None
        axes[0].plot(1e3 * depth, found, color=colors[v["dx"]], linewidth=0.9, label=label)
        axes[1].plot(middle[1:], profile(path, v)[1:], color=colors[v["dx"]], label=label)
    for beta, (value, pressure, height) in THEORY.items():
        axes[0].axhline(value, color="black", linestyle="--", linewidth=1.0,
                        label="theory" if beta == 30 else None)
        axes[0].text(98, value + 2.6, f"{beta} degrees", ha="right", fontsize=8,
                     bbox={"color": "white", "alpha": 0.8, "pad": 1})
        axes[1].plot(height, pressure, "o", markersize=6, markerfacecolor="white",
                     markeredgecolor="black", label="theory, peak" if beta == 30 else None)
    axes[0].set(xlabel="depth of the keel [mm]", ylabel="force / (rho V^3 t)", ylim=(0, 30),
                xlim=(0, 100))
    axes[1].set(xlabel="height / (V t)", ylabel="pressure / (rho V^2 / 2)", ylim=(0, None),
                xlim=(-1, 1))
    free = [(path, v) for path, v in cases.values() if v["body"] == "free"]
    for (path, v), color in zip(free, COLORS[-len(free):] if free else ()):
        s = series.read(path / "force.csv")
        axes[2].plot(1e3 * s.time, s["velocity"], color=color, label=f"dx = {1e3 * v['dx']:.3g} mm")
    for name, mark, label in (("experiment", "o", "experiment"),
                              ("code", "x", "boundary elements")):
        points = series.read(HERE / f"{name}.csv")
        axes[2].plot(1e3 * points.time, points["velocity"], mark, markersize=5,
                     markerfacecolor="white", color="black", label=label)
    axes[2].set(xlabel="time [ms]", ylabel="velocity of the free wedge [m/s]", ylim=(0, None))
    elastic = [(path, v) for path, v in cases.values() if v["body"] == "elastic"]
    for (path, v), color in zip(elastic, COLORS):
        s = series.read(path / "force.csv")
        axes[3].plot(1e3 * s.time, 1e3 * s["deflection"], color=color,
                     label=f"dx = {1e3 * v['dx']:.3g} mm")
    axes[3].plot(*(1e3 * values for values in expected()), "--", color="black", linewidth=1.0,
                 label="Wagner's pressure on beams")
    axes[3].set(xlabel="time [ms]", ylabel="deflection of an elastic face [mm]", xlim=(0, 2),
                ylim=(0, None))
    for each in axes:
        each.legend(fontsize=7)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
