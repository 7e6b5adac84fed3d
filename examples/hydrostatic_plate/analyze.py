#!/usr/bin/env python3
"""Figures and pictures of the plate under water.   usage: analyze.py FOLDER

main reads plate.csv, particles.dump and log.lammps of one run and writes summary.json,
deflection.png and pressure.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER = 1
# [micrometre] finite elements, plane strain, water and the plate's own weight, middle line
REFERENCE = -70.66
THIN = -68.6  # [micrometre] thin-plate theory, as the literature quotes it
SOURCE = "finite elements, 9-node quadrilaterals"
TARGETS = {5: 0.10, 11: 0.05}  # of the deflection, by particles across
DEPTH = 2.0  # [m]


def settled(plate, values):
    """The deflection [micrometre] after the water is no longer damped: from half of the run on, if
    damping had ended by then."""
    late = plate.time > max(0.5 * plate.time[-1], values["tdamp"])
    return plate.time[late], 1e6 * plate["deflection"][late]


def add(summary, plate, values, suffix=""):
    """Mean, scatter and drift of the deflection."""
    time, deflection = settled(plate, values)
    mean = deflection.mean()
    target = TARGETS.get(round(values["across"])) if values["coarser"] == 1 else None
    summary.add(f"deflection{suffix}", mean, "um", REFERENCE, SOURCE, target)
    summary.add(f"scatter{suffix}", deflection.std() / abs(mean), "of the mean")
    slope = np.polyfit(time, deflection, 1)[0]
    summary.add(f"drift{suffix}", slope * np.ptp(time) / mean, "of the mean", target=0.01 if target
                else None)


def picture(path, runs):
    """Deflection over time. runs: [(plate, label)]."""
    end = max(plate.time[-1] for plate, _ in runs)
    with plot.picture(path) as figure:
        axes = figure.add_subplot()
        for (plate, label), colour in zip(runs, (plot.BLUE, plot.ORANGE)):
            axes.plot(plate.time, 1e6 * plate["deflection"], color=colour, label=label)
        axes.plot((0.0, end), (REFERENCE, REFERENCE), "--", color=plot.GREY, linewidth=1.2,
                  label="finite elements")
        axes.plot((0.0, end), (THIN, THIN), ":", color=plot.GREY, linewidth=1.2, label="thin plate")
        axes.set(xlabel="time [s]", ylabel="deflection at mid-span [μm]", ylim=(-80.0, -60.0))
        axes.legend()
        figure.tight_layout()


def read(folder):
    """What a run left: the deflection over time and the values of the log."""
    return series.read(Path(folder) / "plate.csv"), log.read(Path(folder) / "log.lammps").values


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    plate, values = read(folder)
    add(summary, plate, values)

    leaks = Leaks(0.5 * values["dx"])
    water = None
    for frame in dump.frames(folder / "particles.dump"):
        water = frame.of_types(WATER)
        leaks.see(water)
        leaks.beyond_walls(water, [("x", 0.0, -1), ("x", 1.0, 1), ("y", 0.0, -1)])
    exact = 9810.0 * (DEPTH - water["y"])
    summary.add("pressure_l2", float(np.linalg.norm(water["p"] - exact) / np.linalg.norm(exact)))
    summary.add("particles_leaked", leaks.count(summary.log), target=0)

    picture(folder / "deflection.png",
            [(plate, f"{values['across']:.0f} particles through the thickness")])
    plot.deviations(folder / "pressure.png", DEPTH - water["y"], water["p"], exact, 9810.0 * DEPTH,
                    "error of p, over p at the plate [%]", f"t = {plate.time[-1]:.2f} s")
    return summary.write()


def study(folder, cases):
    """Deflection of all cases, and what the pressure is off in those with coarser water."""
    summary = Summary(folder)
    runs = []
    for name, path in cases.items():
        plate, values = read(path)
        add(summary, plate, values, f"_{name.removesuffix('_across')}")
        if values["coarser"] == 1:
            runs.append((plate, f"{values['across']:.0f} particles through the thickness"))
        else:
            summary.add(f"pressure_l2_{name}", next(f["value"]
                                                    for f in summary.cases[name]["figures"]
                                                    if f["name"] == "pressure_l2"))
    picture(Path(folder) / "deflection.png", runs)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
