#!/usr/bin/env python3
"""Figures and pictures of the rotating square patch.   usage: analyze.py FOLDER

main(folder) reads series.csv, particles.dump and log.lammps of one run; study(folder, cases)
compares runs.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.geometry import min_pair_distance  # noqa: E402
from fsi.summary import Summary  # noqa: E402

SERIES = "Fourier series of laplacian p = 2 rho omega^2 in the square"
CENTRE = -0.147343  # of rho omega^2 L^2, at t = 0
# [1/omega] means over a start that short are those of the start: the patch turns by 3 degrees
EARLY = 0.05
LABELS = {"best": "shifting", "shaken": "shifting, shaken start", "plain": "no shifting"}
LIMITS, PRESSURES = ((-1.0, 1.0), (-1.0, 1.0)), (-0.15, 0.05)


def arm_lengths(frame):
    """Distance from the centre of each arm's tip: the farthest hundredth of the particles, in four
    clusters a quarter turn apart."""
    r, angle = np.hypot(frame["x"], frame["y"]), np.arctan2(frame["y"], frame["x"])
    far = r > np.quantile(r, 0.98)
    # the tips' common direction, modulo a quarter turn
    middle = np.angle(np.mean(np.exp(4j * angle[far]))) / 4.0
    arm = np.round((angle - middle) / (0.5 * np.pi)).astype(int) % 4
    # the fifth farthest: single particles that come off do not count
    return np.array([np.sort(r[arm == k])[-5] for k in range(4)])


def figures(folder):
    """What is measured of a run, as {name: (value, unit, reference, source)}, and its frames and
    series."""
    spacing = log.read(Path(folder) / "log.lammps").values["dx"]
    frames, table = dump.read(Path(folder) / "particles.dump"), series.read(
        Path(folder) / "series.csv")
    early = table.time <= EARLY
    arms = arm_lengths(frames[-1])
    found = {
        "centre_pressure": (1e-3 * table["centre"][early].mean(), "rho w2 L2", CENTRE, SERIES),
        "angular_momentum_drift": (table["spin"][-1] / table["spin"][0] - 1.0, "", None, None),
        "kinetic_energy_drift": (table["ke"][-1] / table["ke"][0] - 1.0, "", None, None),
        "arm_length": (arms.mean(), "L", None, None),
        "arm_asymmetry": ((arms.max() - arms.min()) / arms.mean(), "", None, None),
        "voids": (sum(int(f["surface"][np.hypot(f["x"], f["y"]) < 0.25].sum()) for f in frames), "",
                  None, None),
        "min_pair_distance": (min_pair_distance(frames[-1].vector("xy"), spacing) / spacing, "dx",
                              None, None),
    }
    return found, frames, table, spacing


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    found, frames, table, spacing = figures(folder)
    for name, (value, unit, reference, source) in found.items():
        summary.add(name, value, unit, reference, source)
    shown = dump.nearest(frames, (0.0, 1.0, 2.0), frames[-1].time)
    plot.clouds(folder / "patch.png", [(f"t = {f.time:.2f} / omega", f["x"], f["y"], 1e-3 * f["p"])
                                       for f in shown], spacing,
                LIMITS, "pressure / rho omega$^2$ L$^2$", PRESSURES, ("x / L", "y / L"))
    plot.lines(folder / "centre.png", "t omega", "pressure at the center / rho omega$^2$ L$^2$",
               [(table.time, 1e-3 * table["centre"], "SPH", plot.BLUE)],
               [([0.0], [CENTRE], "Fourier series, t = 0", plot.ORANGE)])
    return summary.write()


def study(folder, cases):
    """The first case's figures are the scene's; the others' have its name behind theirs."""
    folder = Path(folder)
    summary = Summary(folder)
    targets = {"centre_pressure": 0.02, "angular_momentum_drift": 0.02, "voids": 0}
    panels, curves = [], []
    for k, (name, path) in enumerate(cases.items()):
        found, frames, table, spacing = figures(path)
        for figure, (value, unit, reference, source) in found.items():
            summary.add(figure + (f"_{name}" if k else ""), value, unit, reference, source,
                        None if k else targets.get(figure))
        label = LABELS.get(name, name)
        times = (1.0, 2.0) if k == 0 else (2.0,) if name == "shaken" else (1.0,)
        panels += [(f"{label}, t = {f.time:.2f} / omega", f["x"], f["y"], 1e-3 * f["p"])
                   for f in dump.nearest(frames, times, frames[-1].time)]
        widest = max(spacing, widest) if k else spacing
        curves.append((table.time, 1e-3 * table["centre"], label,
                       (plot.BLUE, plot.ORANGE, plot.GREY)[k % 3]))
    plot.clouds(folder / "patch.png", panels, widest, LIMITS, "pressure / rho omega$^2$ L$^2$",
                PRESSURES, ("x / L", "y / L"))
    plot.lines(folder / "centre.png", "t omega", "pressure at the center / rho omega$^2$ L$^2$",
               curves,
               [([0.0], [CENTRE], "Fourier series, t = 0", "black")])
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
