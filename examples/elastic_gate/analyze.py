#!/usr/bin/env python3
"""Figures and pictures of the elastic gate.   usage: analyze.py FOLDER

Reads tip.csv, particles.dump and log.lammps in FOLDER, which tools/run makes; writes summary.json, tip.png and
snapshots.png there.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.geometry import project_on_polyline  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER, RUBBER, CLAMPED = 1, 2, 3
WATER_AREA = 0.1 * 0.14  # [m^2]
GATE_FACE, GATE_LENGTH, GATE_THICKNESS = 0.1, 0.079, 0.005  # [m]; held above GATE_LENGTH, floor at y = 0
WALL_FROM = 0.085  # [m] above this the wall that holds the gate must be tight; below, the gate's bend moves it
SNAPSHOT_TIMES = (0.0, 0.08, 0.16, 0.24, 0.32, 0.4)  # [s]
SOURCE = "experiment, Antoci, Gallati & Sibilla 2007"


class Midline:
    """The gate's middle line: rows of rubber particles, from the clamp to the free end, averaged over the thickness."""

    def __init__(self, first):
        """`first`: the frame in which the gate is straight."""
        rubber = first.of_types(RUBBER, CLAMPED)
        rows, self.row_of = np.unique(np.round(rubber["y"], 6), return_inverse=True)
        # rows come from the free end upwards; counted from the top, so that the line runs downwards
        self.row_of = len(rows) - 1 - self.row_of
        self.fraction = (GATE_LENGTH - rows[::-1]) / GATE_LENGTH  # 0 at the clamp, 1 at the free end
        self.count = np.bincount(self.row_of)

    def place(self, frame, points):
        """Of points (n, 2): distance (n,) to the line, side (n,) +1 or -1, fraction (n,) of the gate's length."""
        rubber = frame.of_types(RUBBER, CLAMPED)
        line = np.column_stack([np.bincount(self.row_of, rubber[name]) / self.count for name in "xy"])
        reach = 3.0 * GATE_THICKNESS
        near = np.all((points > line.min(axis=0) - reach) & (points < line.max(axis=0) + reach), axis=1)
        distance, side = np.full(len(points), np.inf), np.zeros(len(points), int)
        fraction = np.full(len(points), np.nan)
        if near.any():
            distance[near], side[near], where = project_on_polyline(points[near], line)
            fraction[near] = np.interp(where, np.arange(len(line)), self.fraction)
        return distance, side, fraction


def count_leaks(frames, spacing, log):
    """Number of water particles that pass a wall or the gate, over an iterable of all frames."""
    leaks = Leaks(0.5 * spacing)
    midline = before = None
    for frame in frames:
        midline = midline or Midline(frame)
        water = frame.of_types(WATER)
        leaks.see(water)
        leaks.beyond_walls(water, [("x", 0.0, -1), ("y", 0.0, -1)])

        in_wall = (water["x"] > GATE_FACE + leaks.margin) & (water["x"] < GATE_FACE + GATE_THICKNESS - leaks.margin)
        leaks.add(water, in_wall & (water["y"] > WALL_FROM))

        distance, side, fraction = midline.place(frame, water.vector("xy"))
        # away from the clamp's corner and from the free end, which water may round
        beside = (fraction > 0.05) & (fraction < 0.9) & (distance < 2.5 * GATE_THICKNESS)
        leaks.add(water, beside & (distance < 0.25 * GATE_THICKNESS))

        now = {"id": water["id"], "x": water["x"], "y": water["y"], "side": np.where(beside, side, 0)}
        if before is not None:
            _, new, old = np.intersect1d(now["id"], before["id"], assume_unique=True, return_indices=True)
            crossed = np.zeros(len(water), bool)
            crossed[new] = now["side"][new] * before["side"][old] < 0
            crossed[new] |= _crosses_wall(before["x"][old], before["y"][old], now["x"][new], now["y"][new])
            leaks.add(water, crossed)
        before = now
    return leaks.count(log)


def _crosses_wall(x0, y0, x1, y1):
    """Whether the way from (x0, y0) to (x1, y1), arrays (n,), crosses the wall above the gate."""
    crosses = (x0 - GATE_FACE) * (x1 - GATE_FACE) < 0.0
    share = np.divide(GATE_FACE - x0, x1 - x0, out=np.zeros_like(x0), where=crosses)
    return crosses & (y0 + share * (y1 - y0) > WALL_FROM)


def mass_error(log, first, last):
    """Relative change of the mass in the run, from thermo if it has it, else from the number of particles."""
    mass = log.column("v_mass", "mass", "Mass")
    start, end = (mass[0], mass[-1]) if mass is not None else (len(first), len(last))
    return abs(end - start) / start


def picture_tip(path, tip, experiment):
    """Both displacements of the free end against the experiment."""
    plot.lines(
        path, "time [s]", "displacement of the free end [mm]",
        [(tip.time, 1e3 * tip["tip_x"], "horizontal", plot.BLUE),
         (tip.time, 1e3 * tip["tip_y"], "vertical", plot.ORANGE)],
        [(experiment.time, 1e3 * experiment["horizontal"], "horizontal, experiment", plot.BLUE),
         (experiment.time, 1e3 * experiment["vertical"], "vertical, experiment", plot.ORANGE)])


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    tip = series.read(folder / "tip.csv")
    experiment = series.read(HERE / "experiment.csv")

    for name in ("tip_x", "tip_y"):
        column = "horizontal" if name == "tip_x" else "vertical"
        peak, time = tip.peak(name)
        measured, measured_time = experiment.peak(column)
        summary.add(f"{name}_peak", 1e3 * peak, "mm", 1e3 * measured, SOURCE)
        summary.add(f"{name}_peak_time", time, "s", measured_time, SOURCE)
    for name, column in (("x", "horizontal"), ("y", "vertical")):
        rms = series.rms_distance(tip, f"tip_{name}", experiment, column)
        summary.add(f"rms_{name}_experiment", None if rms is None else 1e3 * rms, "mm")

    # one pass over a file that may be large; only the frames for the pictures are kept
    kept, ends = {}, {}

    def passing():
        for frame in dump.frames(folder / "particles.dump"):
            ends.setdefault("first", frame)
            ends["last"] = frame
            for time in SNAPSHOT_TIMES:
                if time not in kept or abs(frame.time - time) < abs(kept[time].time - time):
                    kept[time] = frame
            yield frame

    first = next(dump.frames(folder / "particles.dump"))
    spacing = summary.log.values.get("dx") or float(np.sqrt(WATER_AREA / len(first.of_types(WATER))))
    summary.add("particles_leaked", count_leaks(passing(), spacing, summary.log))
    summary.add("mass_error", mass_error(summary.log, ends["first"], ends["last"]))

    picture_tip(folder / "tip.png", tip, experiment)
    shown = dump.nearest(list(kept.values()), SNAPSHOT_TIMES, tolerance=0.02)
    plot.snapshots(folder / "snapshots.png", shown, spacing, (WATER,), (RUBBER, CLAMPED),
                   limits=((-0.005, 0.3), (-0.005, 0.15)))
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
