#!/usr/bin/env python3
"""Figures and pictures of a cylinder on a spring in a stream.   usage: analyze.py FOLDER

main reads series.csv, particles.dump and log.lammps of one run; study compares the runs of
cases.json.
"""

import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, geometry, log, plot, series  # noqa: E402
from fsi.summary import Summary  # noqa: E402

DIAMETER = 0.1
SOURCE = "code, Ahn & Kallinderis 2006"
# reduced velocity: largest amplitude [D] of Ahn and Kallinderis, of Borazjani et al.
CODES = {3: (0.071, 0.071), 4: (0.562, 0.529), 5: (0.523, 0.489), 6: (0.451, 0.435),
         7: (0.371, 0.381), 8: (0.070, 0.070)}
INNER, EDGES = (4, 6), (3, 8)  # reduced velocities with a target
EDGE = 0.1  # [D] target of the amplitude there
LATE = 20.0  # [D/U] at the end, whose amplitude counts


def read(folder):
    """(values of the log, time [D/U], place [D], coefficients of drag and lift)"""
    s = series.read(Path(folder) / "series.csv")
    values = log.read(Path(folder) / "log.lammps").values
    factor = 2.0 / (1000.0 * values["velocity"] ** 2 * DIAMETER)
    return (values, s.time * values["velocity"] / DIAMETER, s["place"] / DIAMETER,
            s["drag"] * factor, s["lift"] * factor)


def figures(time, place, drag):
    """Of the last LATE: half the way between the ends, frequency, mean drag; and the amplitude of
    the LATE before, which is the same in a settled state."""
    late = time >= time[-1] - LATE
    before = (time >= time[-1] - 2 * LATE) & ~late
    out = {"amplitude": 0.5 * np.ptp(place[late]),
           "frequency": series.frequency(time[late], place[late]), "drag": drag[late].mean()}
    if before.any() and time[0] < time[-1] - 2 * LATE + 1.0:
        out["amplitude_before"] = 0.5 * np.ptp(place[before])
    return out


def target(reduced):
    """(reference, target): the spread of both codes and 5 %, from the mean of both; at the edges a
    bound of the value itself."""
    if reduced in EDGES:
        return None, EDGE
    low, high = sorted(CODES[reduced])
    middle = 0.5 * (low + high)
    return middle, (high - middle) / middle + 0.05 if reduced in INNER else None


def add(summary, folder, suffix="", judged=True):
    """The figures of one run; returns its values, time and place."""
    values, time, place, drag, _ = read(folder)
    reduced = round(values["reduced"], 6)
    for name, value in figures(time, place, drag).items():
        if name == "amplitude" and reduced in CODES:
            reference, bound = target(int(reduced))
            summary.add(name + suffix, value, "D", reference,
                        "code, mean of Ahn & Kallinderis 2006, Borazjani et al. 2008" if reference
                        else None,
                        bound if judged else None)
        else:
            summary.add(name + suffix, value,
                        {"frequency": "U/D"}.get(name, "D" if "amplitude" in name else ""))
    return values, time, place


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    values, time, place = add(summary, folder)
    plot.lines(folder / "place.png", "t U/D", "place y/D",
               [(time, place, f"reduced velocity {values['reduced']:g}", plot.BLUE)])
    last = dump.read(folder / "particles.dump")[-1]
    water, body = last.of_types(1, *range(3, 8)), last.of_types(2)
    spin = geometry.vorticity_of_levels(water, values["dx"]) * DIAMETER / values["velocity"]
    x, y = water["x"] / DIAMETER, water["y"] / DIAMETER
    # the cylinder's particles in the middle of the color scale, grey would be the water's zero
    x, y = np.append(x, body["x"] / DIAMETER), np.append(y, body["y"] / DIAMETER)
    plot.clouds(folder / "vorticity.png",
                [(f"t U/D = {last.time * values['velocity'] / DIAMETER:.0f}", x, y,
                  np.append(np.clip(spin, -3, 3), 0 * body["x"]))],
                values["dx"] / DIAMETER, ((-2, x.max()), (-3, 3)), "vorticity D/U",
                axis_labels=("x/D", "y/D"), panel_width=6.0, colours="RdBu_r")
    return summary.write()


def study(folder, cases):
    """Amplitudes over reduced velocity, and the way of some."""
    folder = Path(folder)
    summary = Summary(folder)
    found, curves = {}, []
    # they are in the order of resolution
    finest = {round(read(path)[0]["reduced"]): name for name, path in cases.items()}
    for name, path in cases.items():
        values, time, place = add(summary, path, f"_{name}", name in finest.values())
        found.setdefault((values["across"], values["finest"]), []).append(
            (values["reduced"], 0.5 * np.ptp(place[time >= time[-1] - LATE])))
        curves.append((name, time, place))
    shown = cases.get(finest.get(4), folder) / "vorticity.png"  # the page's picture
    if shown.exists() and shown.parent != folder:
        shutil.copyfile(shown, folder / shown.name)
    with plot.picture(folder / "amplitude.png", 9.0, 3.6) as figure:
        left, right = figure.subplots(1, 2)
        for k, (label, mark) in enumerate((("Ahn & Kallinderis 2006", "s"),
                                           ("Borazjani et al. 2008", "o"))):
            left.plot(list(CODES), [pair[k] for pair in CODES.values()], mark, markersize=6,
                      markerfacecolor="white", color="black", label=label)
        for ((across, most), points), color, line in zip(
            sorted(found.items(), key=lambda item: item[0][1]),
            (plot.BLUE, plot.ORANGE, plot.GREEN), "-::"):
            label = f"{across:.0f}" if round(most) == across else f"{across:.0f} to {most:.0f}"
            left.plot(*np.array(sorted(points)).T, line, marker="o", markersize=4, color=color,
                      label=f"{label} particles per diameter")
        left.axhline(EDGE, color=plot.GREY, linestyle="--", linewidth=1.0)
        left.set(xlabel="reduced velocity", ylabel="amplitude / D", ylim=(0, 0.7))
        for (name, time, place), color in zip([c for c in curves if c[0] in ("4_8", "8_8")],
                                              (plot.BLUE, plot.ORANGE)):
            right.plot(time, place, color=color, linewidth=0.9,
                       label=f"reduced velocity {name.split('_')[0]}")
        right.set(xlabel="t U/D", ylabel="place y/D", ylim=(-0.6, 0.8))
        for axes in (left, right):
            axes.legend(fontsize=7)
        figure.tight_layout()
    return summary.write()


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
