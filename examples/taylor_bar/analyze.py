#!/usr/bin/env python3
"""Figures and pictures of the Taylor bar.   usage: analyze.py FOLDER

main reads bar.csv, particles.dump and log.lammps of one run and writes summary.json, bar.png and
length.png beside them; study compares the runs of cases.json.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

RADIUS, LENGTH = 3.2, 32.4  # [mm]
# Converged finite elements at 80 us, the foot held to the wall. Length: 15-node tetrahedra of the
# code Carina, 21.420 to 21.425 mm on three meshes (benchmark/tet15-p1/taylor in its repository).
# Radius: hexahedra of Foulk et al., as quoted there; 7.12 mm by Simo 1992.
LENGTH_FEM, RADIUS_FEM = 21.42, 7.22
LENGTH_SOURCE = "code: converged finite elements (Carina)"
RADIUS_SOURCE = "code: converged finite elements, Foulk et al. 2021"
SNAPSHOTS = (0.0, 1e-5, 2e-5, 4e-5, 8e-5)
COLOURS = ("#9ec4e4", "#5b9bd5", plot.BLUE, plot.ORANGE)


def foot_radius(first, frame):
    """Radius [mm] to which the edge of the end face has gone: the line through the two outermost
    circles of its particles, at the bar's radius."""
    foot = np.abs(first["z"]) < 1e-9
    before, now = (1e3 * np.hypot(f["x"], f["y"])[foot] for f in (first, frame))
    circle = np.round(before, 6)
    (a, b), (ra, rb) = np.unique(circle)[-2:], [now[circle == c].mean()
                                                for c in np.unique(circle)[-2:]]
    return float(ra + (rb - ra) / (b - a) * (RADIUS - a))


def asymmetry(first, frame, spacing):
    """Largest distance of a particle from its image in the planes x = 0 and x = y, in spacings."""
    def where(f):
        return np.round(f.vector() / spacing).astype(int)
    at = {tuple(cell): k for k, cell in enumerate(where(first))}
    cells, x = where(first), frame.vector()
    mirror = np.array([at[-a, b, c] for a, b, c in cells])
    turn = np.array([at[b, a, c] for a, b, c in cells])
    return max(np.abs(x - x[mirror] * (-1.0, 1.0, 1.0)).max(),
               np.abs(x - x[turn][:, [1, 0, 2]]).max()) / spacing


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    spacing = summary.log.values["dx"]
    bar = series.read(folder / "bar.csv")
    frames = dump.read(folder / "particles.dump")
    first, last = frames[0], frames[-1]
    start = bar["kinetic"][0]

    summary.add("final_length", 1e3 * bar["length"][-1], "mm", LENGTH_FEM, LENGTH_SOURCE)
    summary.add("shortest_length", 1e3 * bar["length"].min(), "mm")
    summary.add("foot_radius", foot_radius(first, last), "mm", RADIUS_FEM, RADIUS_SOURCE)
    summary.add("outermost_particle", 1e3 * np.hypot(last["x"], last["y"]).max(), "mm")
    summary.add("largest_vonmises", 1e-6 * last["vonmises"].max(), "MPa")
    summary.add("plastic_work", bar["plastic"][-1] / start, "of the kinetic energy")
    summary.add("energy_to_viscosity", bar["viscosity"][-1] / start, "of the kinetic energy")
    summary.add("energy_error", np.abs(bar["total"] / start - 1.0).max(), "of the kinetic energy",
                target=0.01)
    push = np.sum(0.5 * (bar["push"][1:] + bar["push"][:-1]) * np.diff(bar.time))
    summary.add("impulse_error", push / (bar["momentum"][-1] - bar["momentum"][0]) - 1.0,
                "of the impulse")
    summary.add("deepest_in_wall", max(-f["z"].min() for f in frames) / spacing, "dx")
    summary.add("asymmetry", max(asymmetry(first, f, spacing) for f in frames), "dx")

    plot.lines(folder / "length.png", "time [us]", "length of the bar [mm]",
               [(1e6 * bar.time, 1e3 * bar["length"], "this run", plot.BLUE)],
               [([80.0], [LENGTH_FEM], "code: converged finite elements", plot.GREY)])
    picture(folder / "bar.png", dump.nearest(frames, SNAPSHOTS, tolerance=frames[-1].time), spacing)
    return summary.write()


def picture(path, frames, spacing):
    """The slice that goes through the axis at the start, coloured by von Mises stress, which beyond
    400 MPa is 100 MPa times the plastic strain higher."""
    cut = np.abs(frames[0]["y"]) < 1e-3 * spacing
    plot.clouds(path, [(f"{1e6 * f.time:.0f} us", 1e3 * f["x"][cut], 1e3 * f["z"][cut],
                        1e-6 * f["vonmises"][cut]) for f in frames], 1e3 * spacing,
                ((-8.0, 8.0), (-1.0, 34.0)), "von Mises stress [MPa]", (0.0, 700.0),
                ("x [mm]", "z [mm]"), 1.4, plot.SOLID_COLOURS)


def _label(name):
    rows, _, ul = name.partition("_across")
    return f"{rows} particles over the diameter{', updated Lagrangian' if ul else ''}"


def study(folder, cases):
    """Lengths in all cases; the figures of each with the case's name."""
    summary = Summary(folder)
    curves = []
    for (name, path), colour in zip(cases.items(), COLOURS):
        for figure in summary.cases[name]["figures"]:
            if figure["name"] in ("final_length", "foot_radius", "outermost_particle",
                                  "energy_to_viscosity", "energy_error", "asymmetry"):
                summary.add(f"{figure['name']}_{name}", figure["value"], figure["unit"],
                            figure["reference"], figure["source"], figure["target"])
        bar = series.read(Path(path) / "bar.csv")
        curves.append((1e6 * bar.time, 1e3 * bar["length"], _label(name), colour))
    plot.lines(Path(folder) / "length.png", "time [us]", "length of the bar [mm]", curves,
               [([80.0], [LENGTH_FEM], "code: converged finite elements", plot.GREY)])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
