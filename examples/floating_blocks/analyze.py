#!/usr/bin/env python3
"""Figures and pictures of a block in water.   usage: analyze.py FOLDER

main reads block.csv, particles.dump and log.lammps of one run and writes summary.json, height.png
and snapshots.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER, BLOCK, FLOOR = 1, 2, 3
SOURCE = "Archimedes"
HALF = 0.5  # [dx] largest error of a draft or a gap
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREY, "#2a8c57", "#8b3fa0", "#7fb2d9", "#c79fd3")


def water_level(water, values):
    """Height of the free surface beside the block: the uppermost particles of columns one spacing
    wide, and half a spacing."""
    dx, width, length = (values[name] for name in ("dx", "width", "length"))
    column = (water["x"] / dx).astype(int)
    top = np.full(int(round(width / dx)), -np.inf)
    np.maximum.at(top, np.clip(column, 0, len(top) - 1), water["y"])
    x = (np.arange(len(top)) + 0.5) * dx
    # away from the block, whose face the surface climbs
    free = np.abs(x - 0.5 * width) > 0.5 * length + 3.0 * dx
    return float(top[free & np.isfinite(top)].mean()) + 0.5 * dx


def bottom_of(block):
    """Height of the block's underside: of its lowest particles, and half of their distance to those
    above."""
    heights = np.unique(np.round(block["rest"], 9))
    low, second = (block["y"][np.isclose(block["rest"], h)].mean() for h in heights[:2])
    return low - 0.5 * (second - low)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values = summary.log.values
    dx, ratio = values["dx"], values["ratio"]
    frames = dump.read(folder / "particles.dump")
    rest = frames[0].of_types(BLOCK)["y"]

    leaks = Leaks(0.5 * dx)
    drafts, gaps, tilts = [], [], []
    for frame in frames:
        water, block = frame.of_types(WATER), frame.of_types(BLOCK)
        block.columns["rest"] = rest
        leaks.see(water)
        leaks.beyond_walls(water, [("x", 0.0, -1), ("x", values["width"], 1), ("y", 0.0, -1)])
        inside = ((np.abs(water["x"] - block["x"].mean()) < 0.5 * values["length"] - 1.5 * dx)
                  & (np.abs(water["y"] - block["y"].mean()) < 0.5 * values["height"] - 1.5 * dx))
        leaks.add(water, inside)
        gaps.append(bottom_of(block))
        drafts.append(water_level(water, values) - gaps[-1])
        x, y = block["x"] - block["x"].mean(), block["y"] - block["y"].mean()
        tilts.append(np.degrees(np.polyfit(x, y, 1)[0]))
    late = slice(-(len(frames) // 6), None)  # the last sixth of the run

    if ratio < 1.0:
        exact = ratio * values["height"]
        draft = float(np.mean(drafts[late]))
        summary.add("draft", 1e3 * draft, "mm", 1e3 * exact, SOURCE)
        summary.add("draft_error", (draft - exact) / dx, "dx", target=HALF)
        summary.add("tilt", max(np.abs(tilts[late])), "degrees")
    else:
        history = series.read(folder / "block.csv")
        summary.add("fastest_fall", -history["vy"].min(), "m/s")
        summary.add("gap_to_floor", float(np.mean(gaps[late])) / dx, "dx", target=HALF)
    summary.add("particles_leaked", leaks.count(summary.log), target=0)
    summary.add("min_pair_distance", min_pair_distance(frames[-1].vector(), dx) / dx, "dx")

    height = np.array(gaps) if ratio >= 1.0 else np.array(drafts)
    plot.lines(folder / "height.png", "time [s]", "height of the underside over the floor [mm]"
               if ratio >= 1.0 else "draft [mm]",
               [([f.time for f in frames], 1e3 * height, f"density ratio {ratio:g}", plot.BLUE)])
    plot.snapshots(folder / "snapshots.png",
                   dump.nearest(frames, (0.0, 0.3, frames[-1].time), frames[-1].time), dx, (WATER,),
                   (BLOCK, FLOOR), limits=((0.0, values["width"]), (-3.0 * dx, 0.45)))
    return summary.write()


def study(folder, cases):
    """Drafts of floaters and gaps of sinkers; the way of all blocks."""
    summary = Summary(folder)
    curves = []
    for (name, path), colour in zip(cases.items(), COLOURS):
        values = log.read(Path(path) / "log.lammps").values
        for figure in summary.cases[name]["figures"]:
            if figure["name"] in ("draft", "draft_error", "gap_to_floor", "fastest_fall",
                                  "particles_leaked"):
                summary.add(f"{figure['name']}_{name}", figure["value"], figure["unit"],
                            figure["reference"], figure["source"],
                            figure["target"])
        block = series.read(Path(path) / "block.csv")
        coarser = values["block_dx"] / values["dx"]
        of = "" if coarser == 1.0 else f", spacing {coarser:g} times the water's"
        curves.append((block.time, 1e3 * block["y"], f"density ratio {values['ratio']:g}{of}",
                       colour))
    plot.lines(Path(folder) / "height.png", "time [s]", "height of the block's center [mm]", curves)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
