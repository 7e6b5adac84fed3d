#!/usr/bin/env python3
"""Figures and pictures of the beam under gravity.   usage: analyze.py FOLDER

main reads tip.csv and log.lammps of one run and writes summary.json and tip.png beside them; study
does so for the runs of cases.json.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SOURCE = "finite elements, Turek & Hron 2006"
STATIC = {"ux": -7.187, "uy": -66.10}  # [mm], CSM1
SWING = {"ux": (-14.305, 14.305), "uy": (-63.607, 65.160)}  # [mm] mean and amplitude, CSM3
FREQUENCY = 1.0995  # [Hz], CSM3


def swing(tip, name):
    """(mean, amplitude) of a column as the benchmark defines them, half of maximum plus and minus
    minimum."""
    top, bottom = tip[name].max(), tip[name].min()
    return 0.5 * (top + bottom), 0.5 * (top - bottom)


def frequency(tip):
    """[Hz] from the first to the last downward passage of uy through its mean level; None with
    fewer than two."""
    level = tip["uy"] - swing(tip, "uy")[0]
    k = np.flatnonzero((level[:-1] > 0.0) & (level[1:] <= 0.0))
    if len(k) < 2:
        return None
    crossing = tip.time[k] + np.diff(tip.time)[k] * level[k] / (level[k] - level[k + 1])
    return float((len(k) - 1) / (crossing[-1] - crossing[0]))


def add_swing(summary, tip, suffix=""):
    """CSM3: the figures of the undamped beam."""
    summary.add(f"frequency{suffix}", frequency(tip), "Hz", FREQUENCY, SOURCE, 0.01)
    for name, (mean, amplitude) in SWING.items():
        found = swing(tip, name)
        summary.add(f"amplitude_{name[1]}{suffix}", 1e3 * found[1], "mm", amplitude, SOURCE, 0.03)
        summary.add(f"mean_{name[1]}{suffix}", 1e3 * found[0], "mm", mean, SOURCE, 0.03)


def add_rest(summary, tip, suffix=""):
    """CSM1: where the damped beam ends, and how much of that the last tenth of the time has
    added."""
    for name, reference in STATIC.items():
        summary.add(f"{name}{suffix}", 1e3 * tip[name][-1], "mm", reference, SOURCE, 0.03)
    summary.add(f"still_moving{suffix}",
                abs(tip["uy"][-1] / tip.at("uy", 0.9 * tip.time[-1]) - 1.0), target=1e-3)


def picture_tip(path, runs, points=True):
    """Vertical displacement of the tip. runs: [(tip, label)]."""
    fem = series.read(HERE / "fem.csv")
    end = max(tip.time[-1] for tip, _ in runs)
    with plot.picture(path, 7.4, 3.6) as figure:
        whole, last = figure.subplots(1, 2, gridspec_kw={"width_ratios": (3, 2)}, sharey=True)
        for axes in (whole, last):
            for (tip, label), colour, line in zip(runs, (plot.BLUE, plot.ORANGE), ("-", "--")):
                axes.plot(tip.time, 1e3 * tip["uy"], line, color=colour, label=label)
            if points:
                seen = fem.time <= end
                axes.plot(fem.time[seen], 1e3 * fem["uy"][seen], "o", markersize=3.5,
                          markerfacecolor="white", color=plot.GREY,
                          label="finite elements, Turek & Hron")
            axes.set_xlabel("time [s]")
        last.set_xlim(0.8 * end, end)
        whole.set_ylabel("vertical displacement\nof the tip [mm]")
        figure.legend(*whole.get_legend_handles_labels(), ncols=3, loc="upper center",
                      fontsize="small", columnspacing=1.2)
        figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.93))


def picture_beam(path, folder, spacing):
    """The beam at its lowest, colored by von Mises stress."""
    lowest = min(dump.read(folder / "particles.dump"), key=lambda frame: frame["y"].mean())
    plot.snapshots(path, [lowest], spacing, fluid=(), solid=(1, 2),
                   limits=((0.22, 0.61), (0.06, 0.22)), panel_width=5.0)


def read(folder):
    """What a run left: the tip over time and the values of the log."""
    return series.read(Path(folder) / "tip.csv"), log.read(Path(folder) / "log.lammps").values


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    tip, values = read(folder)
    damped = values["damping"] > 0
    (add_rest if damped else add_swing)(summary, tip)
    picture_tip(folder / "tip.png",
                [(tip, f"{values['across']:.0f} particles through the thickness")],
                points=not damped)
    picture_beam(folder / "beam.png", folder, values["dx"])
    return summary.write()


def study(folder, cases):
    """All cases: the static test, and the swing at two resolutions."""
    summary = Summary(folder)
    swings = []
    for name in cases:
        tip, values = read(cases[name])
        suffix = f"_{values['across']:.0f}"
        if values["damping"] > 0:
            add_rest(summary, tip, suffix)
        else:
            add_swing(summary, tip, suffix)
            swings.append((tip, f"{values['across']:.0f} particles through the thickness"))
            # of the finest
            picture_beam(Path(folder) / "beam.png", Path(cases[name]), values["dx"])
    picture_tip(Path(folder) / "tip.png", swings)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
