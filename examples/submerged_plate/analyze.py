#!/usr/bin/env python3
"""Figures and pictures of the submerged plate.   usage: analyze.py FOLDER

main reads plate.csv, particles.dump and log.lammps of one run and writes summary.json, tip.png and
snapshots.png beside them; study compares the runs of cases.json.
"""

import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import Summary  # noqa: E402

WATER, PLATE = 1, 2
YOUNG, POISSON, DENSITY, WATER_DENSITY = 1.0e8, 0.3, 1100.0, 1000.0
PUSHED = 0.08  # [s] the plate swings freely from then on
THEORY = "Timoshenko beam in a potential flow"
TARGET = 0.02


def theory(root, top, thickness, depth, half, sound=np.inf, elements=60, modes=300):
    """Frequencies [Hz] of the first bending mode in vacuo and in water.

    A cantilever from y = root to top in the middle of a tank of half the length `half`, water
    `depth` deep. On one side of the plate's middle the velocity potential is a sum of cos(k y),
    which has no flow through the floor and no pressure at the surface (the period is far from that
    of waves), above the free end, within the thickness, one of cos(q (y - top)), odd about the
    middle. Galerkin's method joins them and gives the added mass of each node of a beam of linear
    elements with one shear point. Finite `sound` makes the water compressible.
    """
    step, nodes = (top - root) / elements, elements + 1
    inertia, bending = thickness**3 / 12.0, YOUNG / (1.0 - POISSON**2) * thickness**3 / 12.0
    shear = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * thickness
    stiffness, mass = np.zeros((2, 2 * nodes, 2 * nodes))
    curvature, slide = np.array([0, -1, 0, 1]) / step, np.array([-1 / step, -0.5, 1 / step, -0.5])
    for e in range(elements):
        at = np.arange(2 * e, 2 * e + 4)
        stiffness[np.ix_(at, at)] += step * (bending * np.outer(curvature, curvature) + shear
                                             * np.outer(slide, slide))
        for first, density in ((0, thickness), (1, inertia)):
            mass[np.ix_(at[first::2], at[first::2])] += DENSITY * density * step / 6.0 * np.array(
                [[2.0, 1.0], [1.0, 2.0]])
    k = (np.arange(modes) + 0.5) * np.pi / depth
    y = np.linspace(root, top, nodes)[:, None]
    zeroth, first = np.diff(np.sin(k * y) / k,
                            axis=0), np.diff(y * np.sin(k * y) / k + np.cos(k * y) / k**2, axis=0)
    shapes = np.zeros((nodes, modes))  # of the nodes' hats in cos(k y)
    shapes[:-1] += (y[1:] * zeroth - first) / step
    shapes[1:] += (first - y[:-1] * zeroth) / step
    above = depth - top
    q = (np.arange(int(modes * above / depth)) + 0.5)[:, None] * np.pi / above
    overlap = sum((np.sin(w * above + k * top) - np.sin(k * top)) / w
                  for w in (np.where(abs(v) < 1e-9, 1e-9, v) for v in (k + q, k - q))) / above

    def lowest(m):
        return 1.0 / np.sqrt(
            np.linalg.eigvals(np.linalg.solve(stiffness[2:, 2:], m[2:, 2:])).real.max())

    omega, vacuo = 0.0, lowest(mass)
    for _ in range(3):
        beside, over = np.sqrt(k**2 - (omega / sound)**2), np.sqrt(q[:, 0]**2 - (omega / sound)**2)
        flow = np.diag(0.5 * depth * beside * np.tanh(beside * (half - 0.5 * thickness)))
        flow += overlap.T @ ((0.5 * above * over / np.tanh(0.5 * over * thickness))[:, None]
                             * overlap)
        wet = mass.copy()
        wet[::2, ::2] += 2.0 * WATER_DENSITY * shapes @ np.linalg.solve(flow, shapes.T)
        omega = lowest(wet)
    return vacuo / (2.0 * np.pi), omega / (2.0 * np.pi)


def swing(time, values):
    """Frequency [Hz], decay [1/s] and scatter of a decaying sine about a mean, by least squares;
    the scatter over its amplitude at the start."""
    time = time - time[0]

    def fit(rate, decay):
        shapes = np.stack([np.ones_like(time),
                           *(np.exp(-decay * time) * wave(2.0 * np.pi * rate * time)
                             for wave in (np.cos, np.sin))], axis=1)
        weights = np.linalg.lstsq(shapes, values, rcond=None)[0]
        return np.sqrt(np.mean((shapes @ weights - values)**2)), weights

    rates, decays = np.linspace(3.0, 12.0, 91), np.linspace(-2.0, 10.0, 25)
    for _ in range(5):
        _, rate, decay = min((fit(rate, decay)[0], rate, decay) for rate in rates
                             for decay in decays)
        rates, decays = (np.linspace(best - values[1] + values[0], best + values[1] - values[0], 11)
                         for best, values in ((rate, rates), (decay, decays)))
    scatter, weights = fit(rate, decay)
    return rate, decay, scatter / np.hypot(*weights[1:])


def read(folder):
    """What a run left: the tip over time and the values of the log."""
    return series.read(Path(folder) / "plate.csv"), log.read(Path(folder) / "log.lammps").values


def add(summary, tip, values, suffix=""):
    """Frequency, decay and scatter of the free end once it is pushed; none if the run has less than
    a period and a half of it."""
    vacuo, expected = theory(
        *(values[name] for name in ("root", "top", "thickness", "depth", "half", "sound")))
    free = tip.time > PUSHED
    if tip.time[-1] - PUSHED < 1.5 / expected:
        return
    rate, decay, scatter = swing(tip.time[free], tip["tip"][free])
    summary.add(f"frequency{suffix}", rate, "Hz", expected, THEORY, TARGET)
    summary.add(f"frequency_in_vacuo{suffix}", vacuo, "Hz")
    summary.add(f"decay{suffix}", decay, "1/s")
    summary.add(f"scatter{suffix}", scatter, "of the amplitude", target=0.01)


def picture(path, runs):
    """The free end over time. runs: [(tip, label)]."""
    plot.lines(path, "time [s]", "displacement of the free end [mm]",
               [(tip.time, 1e3 * tip["tip"], label, colour)
                for (tip, label), colour in zip(runs, (plot.BLUE, plot.ORANGE))])


def _label(values):
    return f"{values['across']:.0f} across, water {values['coarser']:.3g} times coarser"


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    tip, values = read(folder)
    add(summary, tip, values)
    leaks, frames, inside = Leaks(0.5 * values["dx"]), [], 0
    for frame in dump.frames(folder / "particles.dump"):
        water, plate = frame.of_types(WATER), frame.of_types(PLATE).vector("xyz")
        leaks.see(water)
        leaks.beyond_walls(water,
                           [("x", -values["half"], -1), ("x", values["half"], 1), ("y", 0.0, -1)])
        near = water.vector("xyz")[(abs(water["x"]) < 0.02) & (water["y"] < values["top"] + 0.01)]
        inside += sum(((plate - x)**2).sum(axis=1).min() < (0.5 * values["dx"])**2 for x in near)
        frames.append(frame.select(abs(frame["x"]) < 0.1))
    summary.add("particles_leaked", leaks.count(summary.log), target=0)
    summary.add("particles_inside_plate", inside, target=0)
    picture(folder / "tip.png", [(tip, _label(values))])
    shown = [frames[0], frames[len(frames) // 2]]
    plot.snapshots(folder / "snapshots.png", shown, values["dx"] * values["coarser"],
                   fluid=(WATER,), solid=(PLATE,), columns=2)
    return summary.write()


def study(folder, cases):
    """The free end of all cases."""
    folder = Path(folder)
    summary = Summary(folder)
    runs = []
    for path in cases.values():
        tip, values = read(path)
        add(summary, tip, values, f"_{values['across']:.0f}_across")
        runs.append((tip, _label(values)))
    picture(folder / "tip.png", runs)
    shutil.copyfile(Path(next(iter(cases.values()))) / "snapshots.png", folder / "snapshots.png")
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
