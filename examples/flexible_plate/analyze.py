#!/usr/bin/env python3
"""Figures and pictures of the flexible plate in a stream.   usage: analyze.py FOLDER

main reads series.csv, particles.dump and log.lammps of one run and writes summary.json, plate.png
and deflection.png beside them; study compares the runs of cases.json. Types 1, 4, 5, ... are water,
from the coarsest on.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

PLATE = (2, 3)
EXPERIMENT = {"drag": 1.15, "dx": 2.14, "dz": 0.59}  # Luhar and Nepf 2011
# Tian et al. 2014, an immersed boundary and finite elements
COMPUTED = {"drag": 1.03, "dx": 2.12, "dz": 0.54}
SOURCE = "experiment, Luhar & Nepf 2011"
# what the plate is, over its width and rho U^2: length, bending stiffness of a beam, buoyancy per
# length
LENGTH, STIFFNESS, BUOYANCY = 5.0, 19054.9 * 0.2**3 / 12.0, 0.2465
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREEN, plot.RED)
SHOWN = 3.0  # pictures show the plate's surroundings, widths of the plate


def beam(drag, stiffness=STIFFNESS, buoyancy=BUOYANCY, nodes=401):
    """(dx, dz) of the end of an inextensible beam under a force across it that goes with cos^2 of
    its angle to the vertical and adds up to the coefficient `drag` along the stream, and under
    buoyancy: Luhar and Nepf's own model, but for friction.

    The moment at s is the sum over what lies beyond; the angles and the coefficient of the force
    are found by relaxation.
    """
    s = np.linspace(0.0, LENGTH, nodes)
    step = s[1] - s[0]

    def along(values):    # integral from the foot, trapezoidal
        return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * step)])

    def beyond(values):
        return along(values)[-1] - along(values)

    angle = np.zeros(nodes)
    for _ in range(2000):
        across = np.cos(angle)**2
        factor = 0.5 * drag * LENGTH / along(across * np.cos(angle))[-1]
        ahead, up = beyond(factor * across * np.cos(angle)), beyond(buoyancy - factor * across
                                                                    * np.sin(angle))
        moment = beyond(ahead * np.cos(angle) - up * np.sin(angle))
        change = along(moment / stiffness) - angle
        angle = angle + 0.2 * change
        if abs(change).max() < 1e-9:
            break
    return along(np.sin(angle))[-1], LENGTH - along(np.cos(angle))[-1]


def read(folder):
    """What a run left: the series, lengths in widths of the plate and time in widths over velocity,
    and the values of the log."""
    return series.read(Path(folder) / "series.csv"), log.read(Path(folder) / "log.lammps").values


def late(s):
    """The second half of the run"""
    return s.time >= 0.5 * s.time[-1]


def add(summary, folder, suffix="", target=None):
    """Means over the second half of the run, how much they still change from its third quarter to
    its fourth, and their scatter in time."""
    s, values = read(folder)
    s.columns["dx"], s.columns["dz"] = s["ux"], -s["uz"]
    half, last = late(s), s.time >= 0.75 * s.time[-1]
    elastic = values["plate"] == "elastic"
    for name in ("drag", "dx", "dz") if elastic else ("drag",):
        mean = s[name][half].mean()
        summary.add(name + suffix, mean, "" if name == "drag" else "b",
                    *((EXPERIMENT[name], SOURCE, target) if elastic else ()))
        summary.add(f"{name}_scatter{suffix}", s[name][half].std(), "" if name == "drag" else "b")
        summary.add(f"{name}_change{suffix}", s[name][last].mean() - s[name][half & ~last].mean(),
                    "" if name == "drag" else "b")
    if elastic:
        dx, dz = beam(s["drag"][half].mean())
        summary.add(f"dx_of_beam{suffix}", dx, "b")
        summary.add(f"dz_of_beam{suffix}", dz, "b")
        summary.add(f"aside{suffix}", np.abs(s["uy"][half]).max(), "b")
    summary.add(f"side_force_scatter{suffix}", s["side"][half].std())
    summary.add(f"flow{suffix}", s["flow"][half].mean())


def picture_plate(path, frame, values):
    """The plate with its von Mises stress, and the water's speed in a layer behind its middle and
    near the floor: parallel projection."""
    b, speed = values["breadth"], np.linalg.norm(frame.vector(("vx", "vy", "vz")),
                                                 axis=1) / values["velocity"]
    points, spacing = frame.vector("xyz") / b, values["dx"] * 2.0**(
        -np.maximum(frame["type"] - 3, 0) / 3)
    water = ~np.isin(frame["type"], PLATE)
    plate = ~water & (points[:, 2] > 0.0)
    flat = points[:, [0, 2]] + points[:, 1:2] * (0.35, 0.28)    # y goes away from the eye
    # layers of some spacings, so that what stands behind shows where particles are apart
    back = water & (points[:, 1] > 0.0) & (points[:, 1] < 3.01 * spacing)
    floor = water & (points[:, 2] < 2.01 * spacing) & (abs(points[:, 1]) < SHOWN)
    stress = 1e-3 * frame["vonmises"]
    norms = Normalize(0.0, 1.5), Normalize(0.0, max(np.percentile(stress[plate], 99.5), 1e-9)
                                           if plate.any() else 1.0)
    colours = [plot.matplotlib.colormaps[name] for name in (plot.FLUID_COLOURS, plot.SOLID_COLOURS)]
    shown = back | floor | plate
    rgba = np.where(plate[shown, None], colours[1](norms[1](stress[shown])),
                    colours[0](norms[0](speed[shown])))
    limits = [(flat[shown, k].min() - values["dx"], flat[shown, k].max() + values["dx"])
              for k in (0, 1)]
    width = 5.6
    height = width * np.ptp(limits[1]) / np.ptp(limits[0])
    with plot.picture(path, width + 1.5, height + 0.3) as figure:
        axes = figure.add_axes((0.01, 0.01, width / (width + 1.5), height / (height + 0.3)))
        plot.field(axes, *flat[shown].T, np.where(plate, 0.2 / values["across"], spacing)[shown],
                   rgba, limits, -points[shown, 1])
        axes.axis("off")
        axes.set_title(f"t U/b = {frame.time * values['velocity'] / b:.1f}", loc="left", pad=3)
        for norm, colour, bottom, label in ((norms[0], colours[0], 0.54, "speed/U"),
                                            (norms[1], colours[1], 0.06, "stress [kPa]")):
            figure.colorbar(ScalarMappable(norm, colour),
                            cax=figure.add_axes((0.83, bottom, 0.02, 0.38)), label=label)


def picture_deflection(path, runs):
    """Deflection of the free end and drag over time. runs: [(series, label)]."""
    with plot.picture(path, 6.8, 5.6) as figure:
        for axes, (name, column, label) in zip(figure.subplots(3, 1, sharex=True),
                                               (("dx", "ux", "along the stream [b]"),
                                                ("dz", "uz", "downwards [b]"),
                                                ("drag", "drag", "drag coefficient"))):
            for (s, run), colour in zip(runs, COLOURS):
                axes.plot(s.time, -s[column] if name == "dz" else s[column], color=colour,
                          label=run, linewidth=1.0)
            axes.axhline(EXPERIMENT[name], color=plot.GREY, linestyle="--", linewidth=1.0,
                         label="experiment (mean), Luhar & Nepf")
            axes.axhline(COMPUTED[name], color=plot.GREY, linestyle=":", linewidth=1.2,
                         label="computed, Tian et al.")
            axes.set(ylabel=label, ylim=(0.0, 2.2 if name == "drag" else None))
            if name == "dx":
                axes.legend(loc="lower right", fontsize="small")
        axes.set(xlabel="t U/b")
        figure.align_ylabels()
        figure.tight_layout()


def _label(values):
    finest = f" to {values['dx'] * 2**(-values['levels'] / 3):.3g}" if values["levels"] else ""
    return (f"water {values['dx']:.3g}{finest} b, duct {values['width']:.3g} b x "
            f"{values['height']:.3g} b" + (", rigid" if values["plate"] == "rigid" else ""))


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    add(summary, folder)
    s, values = read(folder)
    picture_deflection(folder / "deflection.png", [(s, _label(values))])
    picture_plate(folder / "plate.png", dump.read(folder / "particles.dump")[-1], values)
    return summary.write()


def study(folder, cases):
    """All cases."""
    folder = Path(folder)
    summary = Summary(folder)
    runs = []
    for name, path in cases.items():
        add(summary, path, f"_{name}")
        s, values = read(path)
        runs.append((s, _label(values)))
    picture_deflection(folder / "deflection.png", runs)
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
