#!/usr/bin/env python3
"""Figures and pictures of the dam break onto an elastic plate.   usage: analyze.py FOLDER

main reads plate.csv, particles.dump and log.lammps of one run and writes summary.json, tip.png and
snapshots.png beside them; study compares the runs of cases.json.
"""

import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

import numpy as np  # noqa: E402
from matplotlib.cm import ScalarMappable  # noqa: E402
from matplotlib.colors import Normalize  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import LOG_FILE, Summary  # noqa: E402

WATER, PLATE = 1, 2
# of the plate; Poisson's ratio is 0, so plane strain, plane stress and a beam are the same
YOUNG, DENSITY, GRAVITY = 1.0e6, 2500.0, 9.81
THEORY = "beam theory: Reissner's, bent by hydrostatic pressure and its own weight"
SECTION = "our own 2D run of the section"
SNAPSHOTS = (0.0, 0.12, 0.15, 0.18, 0.24, 0.30)  # [s]
VIEW = "14,14,y"  # azimuth and elevation [degrees] of the picture, and what points up
TARGETS = {3: 0.05, 5: 0.02}  # of the displacement at rest, by particles across the plate
AT_REST = 0.01  # largest share of the displacement that the last tenth of a run to rest may add


def beam(length, height, thickness, column, depth, density=DENSITY, nodes=801):
    """Displacement (along, up) of the free end of a plate that stands clamped in the floor and dams
    water.

    Geometrically exact beam with shear (Reissner 1972) of unit width: the force F and moment M of
    what is above a section are integrated down from the free end under weight and pressure of the
    bent beam, its shape up from the clamp, which is length - height below the floor, in turns until
    nothing changes. The level falls by what the beam gives way.
    """
    s = np.linspace(0.0, length, nodes)
    step = s[1]
    theta = np.zeros(nodes)
    x, y, stretch, kappa, level = np.zeros(nodes), s.copy(), np.ones(nodes), np.zeros(nodes), depth

    def up(values):
        return np.concatenate([[0.0], np.cumsum(0.5 * step * (values[1:] + values[:-1]))])

    for _ in range(200):
        wet_y = y + 0.5 * thickness * np.sin(theta) - (length - height)
        pressure = 1000.0 * GRAVITY * np.clip(level - wet_y, 0.0, None) * (wet_y > 0.0)
        load = pressure * (stretch + 0.5 * thickness * kappa)
        down = [up(q)[-1] - up(q) for q in (load * np.cos(theta), -load * np.sin(theta) - density
                                            * GRAVITY * thickness)]
        normal = down[0] * np.sin(theta) + down[1] * np.cos(theta)
        shear = down[0] * np.cos(theta) - down[1] * np.sin(theta)
        stretch = 1.0 + normal / (YOUNG * thickness)
        slide = shear / (5.0 / 6.0 * 0.5 * YOUNG * thickness)
        dx, dy = stretch * np.sin(theta) + slide * np.cos(theta), stretch * np.cos(
            theta) - slide * np.sin(theta)
        lever = dy * down[0] - dx * down[1]
        kappa = (up(lever)[-1] - up(lever)) / (YOUNG * thickness**3 / 12.0)
        before, theta = x[-1], up(kappa)
        x, y = up(dx), up(dy)
        level = depth - np.sum(x * (wet_y < level) * (wet_y > 0.0)) * step / column
        if abs(x[-1] - before) < 1e-9 * length:
            break
    return x[-1], y[-1] - length


class Plate:
    """The plate's middle surface, of the particles through the thickness at each height and place
    across; first: a frame before it bends."""

    def __init__(self, first, dx):
        self.dx = dx
        self.of = first["type"] == PLATE
        places = np.round(first.vector("yz")[self.of] / dx, 2)
        self.node = np.unique(places, axis=0, return_inverse=True)[1].ravel()

    def inside(self, frame):
        """Which particles are water that is nearer than half a spacing to the middle surface's
        nodes, deep inside of the plate."""
        count = np.bincount(self.node)
        middle = np.column_stack([np.bincount(self.node, values) / count
                                  for values in frame.vector()[self.of].T])
        reach = 0.5 * self.dx
        points = frame.vector()
        near = (frame["type"] == WATER) & np.all((points > middle.min(axis=0) - reach)
                                                 & (points < middle.max(axis=0) + reach), axis=1)
        found = np.zeros(len(frame), bool)
        found[near] = [np.min(np.sum((middle - point)**2, axis=1)) < reach**2
                       for point in points[near]]
        return found


def picture(path, frames, values):
    """The tank at several times, seen from its side and from above: the half of the water behind
    the plate's middle, the whole plate."""
    flat = values["dim"] == 2
    columns, rows = 2, -(-len(frames) // 2)
    length, width = values["tank"], 0.0 if flat else values["width"]
    middle = 0.5 * (values["from"] + values["to"])
    shown = [f.select((f["y"] > 0.0) & ((f["type"] == PLATE) | flat | (f["z"] < middle)))
             for f in frames]
    speeds = [np.linalg.norm(f.vector(("vx", "vy", "vz")), axis=1) for f in shown]
    water = Normalize(0.0, float(np.percentile(
        np.concatenate([v[f["type"] == WATER] for f, v in zip(shown, speeds)]), 99.0)))
    stress = Normalize(0.0, max(1e-3, 1e-3 * float(
        np.percentile(np.concatenate([f.of_types(PLATE)["vonmises"] for f in frames]), 99.0))))
    floor = dump.Frame(0, 0.0, None, dict(zip(
        "xyz", np.array([(0, 0, 0), (length, 0, 0), (length, 0, width), (0, 0, width)], float).T)))
    (floor, *turned), _ = (([floor, *shown], None) if flat else plot.seen([floor, *shown], VIEW))
    edge = 2.0 * values["dx"]
    top = max(float(np.percentile(f["y"], 99.8)) for f in turned) + edge
    limits = (floor["x"].min() - edge, floor["x"].max() + edge), (floor["y"].min() - edge, top)
    panel, bar = 3.9, 0.62
    height = panel * (top - limits[1][0]) / (limits[0][1] - limits[0][0])
    with plot.picture(path, columns * panel, rows * (height + 0.25) + bar, night=True) as figure:
        whole = figure.get_size_inches()
        for k, (frame, speed) in enumerate(zip(turned, speeds)):
            place = np.array((k % columns * panel, (rows - 1 - k // columns) * (height + 0.25)
                              + bar, panel, height))
            axis = figure.add_axes(place / np.tile(whole, 2))
            plate = frame["type"] == PLATE
            colours = plot.WATER(water(speed))
            colours[plate] = plot.STRESS(stress(1e-3 * frame["vonmises"][plate]))
            axis.fill(floor["x"], floor["y"], facecolor="#16223b", edgecolor="#7d8ba3",
                      linewidth=0.7, zorder=-1)
            plot.field(axis, frame["x"], frame["y"], values["dx"], colours, limits,
                       None if flat else frame["depth"])
            axis.axis("off")
            axis.text(0.02, 1.0, f"t = {frame.time:.2f} s", transform=axis.transAxes, va="bottom")
        for n, (norm, colours, label) in enumerate(((water, plot.WATER, "speed of the water [m/s]"),
                                                    (stress, plot.STRESS,
                                                     "von Mises stress of the plate [kPa]"))):
            axis = figure.add_axes((0.04 + 0.5 * n, 0.45 / whole[1], 0.42, 0.1 / whole[1]))
            figure.colorbar(ScalarMappable(norm, colours), cax=axis, label=label,
                            orientation="horizontal")


def picture_tip(path, runs):
    """Displacement of the free end along the tank over time. runs: [(series, label, colour,
    style)]."""
    with plot.picture(path) as figure:
        axes = figure.add_subplot()
        for plate, label, colour, style in runs:
            axes.plot(plate.time, 1e3 * plate["tip_x"], style, color=colour, label=label)
        axes.set(xlabel="time [s]", ylabel="displacement of the free end [mm]")
        axes.legend()
        figure.tight_layout()


def read(folder):
    """What a run left: the plate over time and the values of the log."""
    return series.read(Path(folder) / "plate.csv"), log.read(Path(folder) / LOG_FILE).values


def add_rest(summary, plate, values):
    """The free end at rest against the beam."""
    suffix = f"_{values['across']:.0f}_across"
    along, up = beam(values["length"], values["height"], values["thickness"], values["column"],
                     values["depth"])
    summary.add("tip_x_rest" + suffix, 1e3 * plate["tip_x"][-1], "mm", 1e3 * along, THEORY,
                TARGETS.get(round(values["across"])))
    summary.add("tip_y_rest" + suffix, 1e3 * plate["tip_y"][-1], "mm", 1e3 * up, THEORY)
    summary.add("still_moving" + suffix,
                abs(plate["tip_x"][-1] / plate.at("tip_x", 0.9 * plate.time[-1]) - 1.0),
                target=AT_REST)


def add_motion(summary, plate, values):
    """The largest displacement, how symmetric it all is, and whether the ledger closes."""
    peak, time = plate.peak("tip_x")
    summary.add("tip_x_peak", 1e3 * peak, "mm")
    summary.add("tip_x_peak_time", time, "s")
    summary.add("tip_y_peak", 1e3 * plate["tip_y"].min(), "mm")
    summary.add("fx_peak", plate.peak("fx")[0], "N")
    if values["dim"] == 3:
        until = plate.time <= time
        summary.add("sides_differ_to_peak", np.abs(plate["near"] - plate["far"])[until].max()
                    / peak, "of the peak", target=0.01)
        summary.add("sides_differ", np.abs(plate["near"] - plate["far"]).max() / peak,
                    "of the peak")
        summary.add("water_across", np.abs(plate["across"]).max(), "m/s")
    given = np.ptp(plate["gravity"])
    summary.add("energy_error", np.ptp(plate["energy"]) / given, "of what gravity gave",
                target=1e-2)


def main(folder):
    """Analyses the run in `folder`; returns the summary."""
    folder = Path(folder)
    summary = Summary(folder)
    plate, values = read(folder)
    to_rest = values["damping"] > 0.0
    (add_rest if to_rest else add_motion)(summary, plate, values)

    leaks, solid, kept = Leaks(0.5 * values["dx"]), None, {}
    times = SNAPSHOTS if not to_rest else (0.0, plate.time[-1])
    walls = [("x", 0.0, -1), ("x", values["tank"], 1), ("y", 0.0, -1), ("y", values["roof"], 1)]
    if values["dim"] == 3 and values["from"] > 0.0:
        walls += [("z", 0.0, -1), ("z", values["width"], 1)]
    within = Leaks(0.0)
    for frame in dump.frames(folder / "particles.dump"):
        solid = solid or Plate(frame, values["dx"])
        water = frame.of_types(WATER)
        leaks.see(water)
        leaks.beyond_walls(water, walls)
        within.add(frame, solid.inside(frame))
        if to_rest:  # a dam: no water behind it
            leaks.add(water, water["x"] > values["face"] + values["thickness"])
        for time in times:
            if time not in kept or abs(frame.time - time) < abs(kept[time].time - time):
                kept[time] = frame
    summary.add("particles_leaked", leaks.count(summary.log), target=0)
    summary.add("particles_inside_plate", len(within.offenders))

    picture_tip(folder / "tip.png", [(plate, _label(values), plot.BLUE, "-")])
    shown = dump.nearest(list(kept.values()), [t for t in times if t <= plate.time[-1] + 0.02],
                         tolerance=0.02)
    picture(folder / "snapshots.png", shown, values)
    return summary.write()


def study(folder, runs):
    """Compares the runs {case: folder}: the full width with the section, the one at rest with the
    beam."""
    folder = Path(folder)
    summary = Summary(folder)
    found = {case: read(run) for case, run in runs.items()}
    if "plate" in found:
        add_motion(summary, *found["plate"])
        shutil.copyfile(Path(runs["plate"]) / "snapshots.png", folder / "snapshots.png")
    if "plate" in found and "plate_coarse_water" in found:
        coarse, fine = (1e3 * found[case][0].peak("tip_x")[0]
                        for case in ("plate_coarse_water", "plate"))
        summary.add("coarse_water_tip_x_peak", coarse, "mm", fine, "our own run with one spacing")
    if "full_width" in found and "section" in found:
        full, section = found["full_width"][0], found["section"][0]
        for name, unit, factor in (("peak", "mm", 1e3), ("peak_time", "s", 1.0)):
            a, b = (factor * run.peak("tip_x")[name == "peak_time"] for run in (full, section))
            summary.add(f"full_width_tip_x_{name}", a, unit, b, SECTION, target=0.05)
        summary.add("full_width_to_section", _distance(full, section), "of the peak, RMS")
    for case in ("rest", "rest_5_across"):
        if case in found:
            add_rest(summary, *found[case])
    for name in ("particles_leaked", "particles_inside_plate"):
        summary.add(name, sum(_figure(case, name) for case in summary.cases.values()),
                    target=0 if name == "particles_leaked" else None)
    picture_tip(folder / "tip.png", [(found[case][0], _label(found[case][1]), colour, style)
                                     for case, colour, style in (("plate", plot.BLUE, "-"),
                                                                 ("full_width", plot.ORANGE, "-"),
                                                                 ("section", plot.GREY, "--"))
                                     if case in found])
    return summary.write()


def _distance(run, reference):
    """Root mean square distance of two tips over the reference's peak."""
    times = reference.time[reference.time <= run.time[-1]]
    return float(np.sqrt(np.mean((run.at("tip_x", times) - reference.at("tip_x", times))**2))
                 / reference.peak("tip_x")[0])


def _label(values):
    if values["dim"] == 2:
        return "2D section"
    share = (values["to"] - values["from"]) / values["width"]
    return ("3D, the tank's full width" if share > 0.99
            else f"3D, {100 * share:.0f} % of the tank's width")


def _figure(case, name):
    return next(figure["value"] for figure in case["figures"] if figure["name"] == name)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
