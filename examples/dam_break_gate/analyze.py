#!/usr/bin/env python3
"""Figures and pictures of the dam break behind a lifting gate.   usage: analyze.py FOLDER

main reads plate.csv, particles.dump and log.lammps of one run and writes summary.json, markers.png
and snapshots.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import LOG_FILE, Summary  # noqa: E402

WATER, PLATE, ROOT, GATE = 1, 2, 3, 4
END = 6  # rows at the plate's upper end: around it water changes sides
MARKERS = {"m1": "40", "m2": "65", "m3": "87.5"}  # heights [mm]
COLOURS = (plot.GREEN, plot.ORANGE, plot.BLUE)
SNAPSHOTS = (0.06, 0.28, 0.34, 0.50)  # [s]
AGREES = 0.10  # target: of displacements, from other codes and from the middle water to the finest
# SPHinXsys, commit 9f33297dc6, test_3d_dambreak_elastic_plate_shell, Observer2: marker at 87.5 mm,
# in the middle of the plate. Water 0.2 m wide at
# 8 mm, a shell 199.5 mm wide that the water acts on from 0.25 s on. Its snapshots have no times:
# only the last one's is known, and it is the largest
CODE, CODE_END = "code SPHinXsys, 3D, 25 rows", (0.5, 52.53)  # [s], [mm]


def beside(frame, rows):
    """How far from the plate's middle line the water of a frame is, > 0 towards the gate:
    (distances, rows of the plate that are nearest).

    rows: of each of the plate's particles, counted from the bottom. Water above the upper end, or
    nearest to it, is at no distance (nan).
    """
    solid, water = frame.select(np.isin(frame["type"], (PLATE, ROOT))), frame.of_types(
        WATER).vector("xy")
    middle = np.column_stack([np.bincount(rows, values) / np.bincount(rows)
                              for values in solid.vector("xy").T])
    along = np.gradient(middle, axis=0)
    along /= np.linalg.norm(along, axis=1)[:, None]
    distance, row = np.full(len(water), np.nan), np.zeros(len(water), int)
    for k in np.flatnonzero(water[:, 1] < middle[-1, 1]):
        row[k] = j = ((middle - water[k])**2).sum(axis=1).argmin()
        if j < len(middle) - 1:
            off = water[k] - middle[j]
            distance[k] = along[j, 0] * off[1] - along[j, 1] * off[0]
    return distance, row


def touch(plate, values):
    """When the front, half a spacing ahead of its particle, is at the plate, between two rows of
    the series; None if it never is."""
    ahead = plate["front"] + 0.5 * values["wx"]
    there = np.flatnonzero(ahead >= values["face"])
    if not there.size:
        return None
    k = there[0]
    return float(np.interp(values["face"], ahead[k - 1:k + 1], plate.time[k - 1:k + 1]))


def add_motion(summary, plate, values, suffix="", others=(), source=None, target=None):
    """Largest displacements and when; others: those of a run that this one is compared with."""
    for k, (name, height) in enumerate(MARKERS.items()):
        value, time = plate.peak(name)
        judged = (others[k], source, target) if others else ()
        summary.add(f"peak_{height}{suffix}", 1e3 * value, "mm", *judged)
        if name == "m3":
            summary.add(f"peak_{height}_time{suffix}", time, "s")
    if (time := touch(plate, values)) is not None:
        summary.add(f"touch{suffix}", time, "s")


def is_of_code(plate, values):
    """Is this the other code's scene, to its end?"""
    return values["depth"] == 0.2 and values["lifted"] and plate.time[-1] > 0.99 * CODE_END[0]


def add_code(summary, plate, values, suffix="", target=AGREES):
    """The upper marker against another code's, if this is its scene."""
    if is_of_code(plate, values):
        summary.add(f"end_87.5{suffix}", 1e3 * plate["m3"][-1], "mm", CODE_END[1], CODE, target)
        summary.add(f"largest_87.5{suffix}", 1e3 * plate.peak("m3")[0], "mm", CODE_END[1], CODE,
                    target)


def peaks(plate):
    return [1e3 * plate.peak(name)[0] for name in MARKERS]


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    plate, values = read(folder)
    add_motion(summary, plate, values)
    add_code(summary, plate, values)
    summary.add("load_peak", plate.peak("fx")[0], "N/m")
    summary.add("energy_error", np.ptp(plate["energy"]) / np.ptp(plate["gravity"]),
                "of what gravity gave", target=1e-2)

    leaks, within, through = Leaks(0.5 * values["wx"]), Leaks(0.0), Leaks(0.0)
    frames = dump.read(folder / "particles.dump")
    # of all times, since the plate's particles keep their order
    rows = np.unique(np.round(frames[0].select(np.isin(frames[0]["type"], (PLATE, ROOT)))["y"]
                              / values["sx"], 2), return_inverse=True)[1]
    before = np.nan
    for frame in frames:
        water = frame.of_types(WATER)
        leaks.see(water)
        leaks.beyond_walls(water, [("x", 0.0, -1), ("x", values["tank"], 1), ("y", 0.0, -1)])
        distance, row = beside(frame, rows)
        within.add(water, np.abs(distance) < 0.5 * values["thickness"])
        side = np.where(row < rows.max() - END, np.sign(distance), np.nan)
        through.add(water, side * before < 0.0)
        before = side
    summary.add("particles_leaked", leaks.count(summary.log), target=0)
    summary.add("particles_in_plate", len(within.offenders), target=0)
    summary.add("particles_through_plate", len(through.offenders), target=0)
    picture_markers(folder / "markers.png", [(plate, values, "-")])
    shown = dump.nearest(frames, [t for t in SNAPSHOTS if t < plate.time[-1] + 0.01],
                         tolerance=0.02)
    plot.snapshots(folder / "snapshots.png", shown or frames[-1:], values["wx"], (WATER,),
                   (PLATE, ROOT), wall=(GATE,),
                   limits=((-0.01, values["tank"] + 0.01), (-0.01, 0.05 + values["depth"])),
                   columns=2, panel_width=2.4)
    return summary.write()


def picture_markers(path, runs):
    """The three markers over time, runs: [(plate, values, line)]."""
    with plot.picture(path, 5.2, 3.2) as figure:
        axes = figure.add_subplot()
        for k, (plate, values, line) in enumerate(runs):
            for (name, height), colour in zip(MARKERS.items(), COLOURS):
                label = (f"{height} mm, {values['rows']:g} rows" if k == 0
                         else f"{values['rows']:g} rows" if name == "m3" else None)
                axes.plot(plate.time, 1e3 * plate[name], line, color=colour, label=label)
        if is_of_code(*runs[0][:2]):
            axes.plot(*CODE_END, "o", color=plot.GREY, label="87.5 mm, SPHinXsys")
        axes.set(xlabel="time [s]", ylabel="displacement of the markers [mm]",
                 xlim=(0.2, None) if runs[0][0].time[-1] > 0.3 else (0.0, None))
        axes.legend(fontsize="x-small")
        figure.tight_layout()


def read(folder):
    """What a run left: the plate over time and the values of the log."""
    return series.read(Path(folder) / "plate.csv"), log.read(Path(folder) / LOG_FILE).values


def study(folder, cases):
    """The figures of all cases: water against the finest one, plate against the one of 4 particles,
    no gate against the lifted one."""
    folder = Path(folder)
    summary = Summary(folder)
    runs = {name: read(path) for name, path in cases.items()}
    finest, first = (peaks(runs[name][0]) if name in runs else ()
                     for name in ("100_rows", "50_rows"))
    compared = {"70_rows": (finest, "finest water", AGREES),
                "6_across": (finest, "4 particles through the thickness", AGREES),
                "no_gate": (first, "with the gate", None)}
    for name, (plate, values) in runs.items():
        add_motion(summary, plate, values, f"_{name}", *compared.get(name, ()))
        if name.endswith("_rows"):
            add_code(summary, plate, values, f"_{name}", AGREES if name == "100_rows" else None)
        for figure in summary.cases[name]["figures"]:
            if figure["name"].startswith(("particles", "energy")):
                summary.add(f"{figure['name']}_{name}", figure["value"], figure["unit"],
                            target=figure["target"])
    lines = {"100_rows": "-", "70_rows": "--", "50_rows": ":"}
    if shown := [(*runs[name], line) for name, line in lines.items() if name in runs]:
        picture_markers(folder / "markers.png", shown)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
