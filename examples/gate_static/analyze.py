#!/usr/bin/env python3
"""Figures and pictures of the gate under a static load.   usage: analyze.py FOLDER

main reads tip.csv, particles.dump and log.lammps of one run and writes summary.json, tip.png and
bent.png beside them; study compares runs of several spacings and forms of the solid: summary.json,
convergence.png.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import LOG_FILE, Summary  # noqa: E402

# displacement [mm] of the middle of the free end
REFERENCE = {"tip_x": 34.81, "tip_y": 9.50}
SOURCE = "finite elements, 9-node quadrilaterals, 12 MPa"
TARGET = 0.03  # of the displacement, with total-Lagrangian rubber 5 particles across
JUDGED = ("tl", 5)  # solid and particles across to which the target applies
# by `solid` in the deck
SOLIDS = {"tl": "total Lagrangian", "ul": "updated Lagrangian", "paper": "classic SPH"}
AT_REST = 1e-3  # largest share of the displacement that the last tenth of a run may add
# spacings from the last free row's cell to where the held rows act as a clamp (deck;
# doc/src/theory.rst)
CLAMP = 1.0
FREE_END = (0.1025, 0.0)  # [m] where its middle is before


def add_tip(summary, tip, values, ending=""):
    """The free end at the end of the run, against finite elements where these are of the same
    rubber."""
    same = values["rubber"] == "gate_12MPa"
    judged = same and (values["solid"], values["across"]) == JUDGED
    for name, reference in REFERENCE.items():
        summary.add(name + ending, 1e3 * tip[name][-1], "mm", reference if same else None,
                    SOURCE if same else None,
                    TARGET if judged else None)


def still_moving(tip):
    """Share of the horizontal displacement that the last tenth of the time has added."""
    return abs(tip["tip_x"][-1] / tip.at("tip_x", 0.9 * tip.time[-1]) - 1.0)


def picture_bent(path, frame, spacing, rubber):
    """The bent gate, coloured by von Mises stress, its free end by finite elements."""
    stress = 1e-3 * frame["vonmises"]
    end = (FREE_END[0] + 1e-3 * REFERENCE["tip_x"], FREE_END[1] + 1e-3 * REFERENCE["tip_y"],
           "free end, finite elements")
    plot.clouds(path, [("", frame["x"], frame["y"], stress)], spacing,
                ((0.095, 0.145 if frame["x"].max() < 0.143 else 0.165), (-0.004, 0.088)),
                "von Mises stress [kPa]", (0.0, float(np.percentile(stress, 99.5))),
                colours=plot.SOLID_COLOURS, marks=[end] if rubber == "gate_12MPa" else ())


def picture_convergence(path, found):
    """What the free end is off against the spacing over the thickness. found: {solid: [(tip,
    values)]}."""
    plot.errors(path, "particles through the thickness", "error of the free end's displacement [%]",
                [
        ([values["across"] for _, values in runs],
         [1e5 * tip[name][-1] / REFERENCE[name] - 100.0 for tip, _ in runs],
         f"{label}, {SOLIDS[solid]}", colour)
        for name, label, colour in (("tip_x", "horizontal", plot.BLUE),
                                    ("tip_y", "vertical", plot.ORANGE))
        for solid, runs in found.items()])


def read(folder):
    """What a run left: the free end over time and the values of the log."""
    return series.read(Path(folder) / "tip.csv"), log.read(Path(folder) / LOG_FILE).values


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    tip, values = read(folder)
    add_tip(summary, tip, values)
    summary.add("still_moving", still_moving(tip), target=AT_REST)
    summary.add("effective_length", 1e3 * (values["length"] + CLAMP * values["dx"]), "mm")
    plot.lines(folder / "tip.png", "time [s]", "displacement of the free end [mm]",
               [(tip.time, 1e3 * tip["tip_x"], "horizontal", plot.BLUE),
                (tip.time, 1e3 * tip["tip_y"], "vertical", plot.ORANGE)])
    picture_bent(folder / "bent.png", dump.read(folder / "particles.dump")[-1], values["dx"],
                 values["rubber"])
    return summary.write()


def study(folder, runs):
    """Compares the runs {case: folder} of the same rubber; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    found = {solid: [] for solid in SOLIDS}  # solid -> [(tip, values)], the finest last
    for tip, values in sorted((read(run) for run in runs.values()),
                              key=lambda run: run[1]["across"]):
        found[values["solid"]].append((tip, values))
        ending = "" if values["solid"] == JUDGED[0] else f"_{values['solid']}"
        add_tip(summary, tip, values, f"_{values['across']:.0f}_across{ending}")
    summary.add("still_moving",
                max(still_moving(tip) for tried in found.values() for tip, _ in tried),
                target=AT_REST)
    picture_convergence(folder / "convergence.png",
                        {solid: tried for solid, tried in found.items() if tried})
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
