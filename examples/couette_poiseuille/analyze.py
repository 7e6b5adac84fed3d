#!/usr/bin/env python3
"""Figures and pictures of flow between plates.   usage: analyze.py FOLDER

main(folder) reads particles.dump and log.lammps of one run; study(folder, cases) compares runs.
"""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, plot  # noqa: E402
from fsi.summary import Summary  # noqa: E402

EXACT = "series solution (Morris, Fox & Zhu 1997)"
L, V, NU = 1e-3, 1.25e-5, 1e-6
TIMES = (0.0225, 0.045, 0.1125, 0.225)  # [L^2/nu], those of Morris, Fox & Zhu
COLOURS = (plot.BLUE, plot.ORANGE, "#3a923a", plot.GREY, "#b5b5b5")


def exact(flow, y, t):
    """Velocity at time t after the start from rest, 200 terms"""
    s = y / L
    n = np.arange(1, 201)[:, None]
    if flow == "couette":
        return V * (s + (2 / (n * np.pi) * (-1.0)**n * np.sin(n * np.pi * s)
                         * np.exp(-n**2 * np.pi**2 * t)).sum(0))
    odd = 2 * n - 1
    return V * (4 * s * (1 - s) - (32 / (np.pi * odd)**3 * np.sin(odd * np.pi * s)
                                   * np.exp(-odd**2 * np.pi**2 * t)).sum(0))


def error(flow, frame):
    """RMS of the error over the particles, in units of V"""
    return float(
        np.sqrt(np.mean((frame["vx"] - exact(flow, frame["y"], frame.time * NU / L**2))**2))) / V


def frames(folder):
    """Frames at the published instants, and the last one"""
    found = dump.read(Path(folder) / "particles.dump")
    return dump.nearest(found,
                        [t * L**2 / NU for t in TIMES if t <= found[-1].time * NU / L**2 + 1e-9],
                        found[-1].time) + [found[-1]]


def picture(path, flow, found):
    y = np.linspace(0, L, 21)
    curves, theory = [], []
    for frame, colour in zip(found, COLOURS):
        order = np.argsort(frame["y"])
        t = frame.time * NU / L**2
        theory.append((y / L, exact(flow, y, t) / V, "" if theory else "theory", plot.GREY))
        curves.append((frame["y"][order] / L, frame["vx"][order] / V, f"t = {t:.4g}", colour))
    plot.lines(path, "y / L", "velocity / V", curves, theory)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    flow = summary.run.get("variables", {}).get("flow", "couette")
    found = frames(folder)
    errors = [error(flow, frame) for frame in found]
    summary.add("error_start", max(errors[:-1]))
    summary.add("error_end", errors[-1])
    picture(folder / "profile.png", flow, found)
    return summary.write()


def study(folder, cases):
    """Errors of all runs and orders of convergence."""
    folder = Path(folder)
    summary = Summary(folder)
    ends, starts = {}, {}
    for name, path in cases.items():
        flow = "poiseuille" if "poiseuille" in name else "couette"
        errors = [error(flow, frame) for frame in frames(path)]
        starts[name], ends[name] = max(errors[:-1]), errors[-1]
        finest = name in ("couette_40", "poiseuille_40")
        summary.add(f"error_start_{name}", starts[name], target=0.01 if finest else None)
        summary.add(f"error_end_{name}", ends[name], target=0.01 if finest else None)
        if name == "poiseuille_20":
            picture(folder / "poiseuille.png", flow, frames(path))
    curves = []
    for kind, colour in zip(("couette", "poiseuille", "particle_poiseuille", "solid_poiseuille"),
                            COLOURS):
        n = sorted(int(m[1]) for name in cases if (m := re.fullmatch(kind + r"_(\d+)", name)))
        if n == [10, 20, 40]:
            e = [starts[f"{kind}_{k}"] for k in n]
            summary.add(f"order_{kind}", np.log2((e[0] - e[1]) / (e[1] - e[2])))
            curves.append((n, e, kind.replace("_", ", "), colour))
    if curves:
        plot.lines(folder / "error.png", "particles between the plates", "RMS error / V", curves,
                   log_scale="xy")
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
