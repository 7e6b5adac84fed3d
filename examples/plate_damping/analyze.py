#!/usr/bin/env python3
"""Damping of the oscillating plate against artificial viscosity.   usage: analyze.py FOLDER

main() is that of examples/oscillating_plate, whose deck this scene runs; study() makes the table
and the pictures.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

from fsi import plot, scene  # noqa: E402
from fsi.summary import Summary  # noqa: E402

plate = scene.analysis("oscillating_plate")
main = plate.main

COLOURS = {"cubic_1.2": "#5aa0d8", "cubic_1.3": "#1b5e96", "cubic_1.5": "#0b2c47",
           "quintic_1.0": "#d1611a",
           "quintic_1.3": "#efa36b", "corrected_1.3": "#2a8c57", "nostress_1.3": "#8a4fa0",
           "coarse_1.3": "#c98bd8", "tl_1.5": plot.GREY}
RECIPE = [kind for kind in COLOURS if kind.startswith(("cubic", "quintic"))]
OTHER = {"cubic_1.3": "classic, cubic, 1.3", "corrected_1.3": "corrected gradient",
         "nostress_1.3": "no artificial stress",
         "coarse_1.3": "the same, 5 particles thick", "tl_1.5": "total Lagrangian"}
COLUMNS = ("a5_a1", "period", "stopped_at", "fractured_at", "disorder",
           "neighbour_distance_deviation", "stress_zigzag",
           "mechanical_energy", "taken_by_viscosity", "taken_by_stress")


def study(folder, cases):
    """A5/A1, disorder and where the energy went, by series and artificial viscosity: cases are
    called SERIES_aALPHA."""
    folder = Path(folder)
    summary = Summary(folder)
    table = {}
    for case, path in cases.items():
        kind, _, alpha = case.rpartition("_a")
        table.setdefault(kind, []).append((float(alpha), plate.figures(path)))
    with open(folder / "damping.csv", "w") as file:
        file.write("series,alpha," + ",".join(COLUMNS) + "\n")
        for kind, rows in table.items():
            rows.sort(key=lambda row: row[0])
            for alpha, values in rows:
                file.write(f"{kind},{alpha:g},"
                           + ",".join(_text(values.get(name)) for name in COLUMNS) + "\n")
                summary.add(f"a5_a1_{kind}_a{alpha:g}", values.get("a5_a1"))
    picture_damping(folder / "damping.png", table)
    return summary.write()


def _text(value):
    return "" if value is None else f"{value:.4g}"


def _alpha_axis(axes, rows):
    """Logarithmic from the first value above 0; 0 has its own place."""
    alphas = sorted({alpha for series in rows for alpha, _ in series})
    if not any(alphas):
        return  # only some of the cases ran
    axes.set_xscale("symlog", linthresh=min(a for a in alphas if a > 0.0), linscale=0.5)
    axes.set_xticks(alphas, [f"{a:g}" for a in alphas], rotation=45)
    axes.minorticks_off()
    axes.set_xlim(-0.1 * min(a for a in alphas if a > 0.0), 1.3 * alphas[-1])
    axes.set_xlabel("artificial viscosity α")


def _curves(axes, table, kinds, name, labels):
    for kind in kinds:
        rows = [(a, v[name]) for a, v in table.get(kind, []) if v.get(name)
                and v.get("stopped_at") is None]
        if rows:
            axes.plot(*zip(*rows), "o-", markersize=4, color=COLOURS[kind],
                      label=labels.get(kind, kind.replace("_", ", h/Δx = ")))


def picture_damping(path, table):
    """A5/A1 against alpha by kernel and h; runs that blew up as crosses at the bottom."""
    with plot.picture(path, 8.0, 4.3) as figure:
        panels = figure.subplots(1, 2, sharey=True)
        for axes, kinds, labels, title in (
                (panels[0], RECIPE, {}, "classic SPH"),
                (panels[1], OTHER, OTHER, "other gradients and solids")):
            _curves(axes, table, kinds, "a5_a1", labels)
            for k, kind in enumerate(kinds):
                blown = [a for a, v in table.get(kind, []) if v.get("stopped_at") is not None]
                axes.plot(blown, [0.02 + 0.03 * k] * len(blown), "x", markersize=5,
                          color=COLOURS[kind])
            axes.plot([], [], "x", color=plot.GREY, label="blew up")
            axes.set_title(title, loc="left")
            axes.set_ylim(0.0, 1.05)
            _alpha_axis(axes, [table[kind] for kind in kinds if kind in table])
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.25), ncols=2, fontsize=8)
        panels[0].set_ylabel("A5/A1")
        figure.tight_layout()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
