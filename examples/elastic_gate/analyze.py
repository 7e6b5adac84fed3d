#!/usr/bin/env python3
"""Figures and pictures of the elastic gate.   usage: analyze.py FOLDER

main reads tip.csv, particles.dump and log.lammps in FOLDER, which tools/run makes; writes
summary.json, tip.png and snapshots.png there. study compares runs of several resolutions, moduli
and forms of the solid with experiment and other codes: summary.json, tip.png and convergence.png.
"""

import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "python"))

import numpy as np  # noqa: E402

from fsi import dump, log, plot, series  # noqa: E402
from fsi.geometry import project_on_polyline  # noqa: E402
from fsi.leaks import Leaks  # noqa: E402
from fsi.summary import LOG_FILE, Summary  # noqa: E402

WATER, RUBBER, CLAMPED = 1, 2, 3
WATER_AREA = 0.1 * 0.14  # [m^2]
# [m]; held above GATE_LENGTH, floor at y = 0
GATE_FACE, GATE_LENGTH, GATE_THICKNESS = 0.1, 0.079, 0.005
# [m] above this the wall that holds the gate must be tight; below, the gate's bend moves it
WALL_FROM = 0.085
FAR_END = 1.0  # [m] water may leave the box there
# [s] of a run of up to 1 s; of a longer one
SNAPSHOT_TIMES, LONG_TIMES = (0.0, 0.08, 0.16, 0.24, 0.32, 0.4), (0.0, 1.0, 2.0, 4.0)
LONG = "long"  # the case that is about what is left at the end
SOURCE = "experiment, Antoci, Gallati & Sibilla 2007"
CODES = {"khayyer2018": ("Khayyer et al. 2018", "--"), "yang2012": ("Yang et al. 2012", "-."),
         "ng2020": ("Ng et al. 2020", ":")}
COMPONENTS = {"x": "horizontal", "y": "vertical"}
# Peaks of the codes' digitised curves: horizontal [mm], its time [s], vertical [mm]. Their moduli
# and plane are not known here
CODE_PEAKS = {"khayyer2018": (42.7, 0.115, 14.8), "yang2012": (39.3, 0.120, 13.1),
              "ng2020": (39.0, 0.116, 13.7)}
MASS_DIGITS = 1e-6  # to which log and dump write masses and densities
# of the peak: away from the experiment; change from one resolution to the next
PEAK_TARGET, CONVERGED = 0.10, 0.02
COARSER = 0.02  # change of a peak with coarser water


class Midline:
    """The gate's middle line: rows of rubber particles, from the clamp to the free end, averaged
    over the thickness."""

    def __init__(self, first):
        """`first`: the frame in which the gate is straight."""
        rubber = first.of_types(RUBBER, CLAMPED)
        rows, self.row_of = np.unique(np.round(rubber["y"], 6), return_inverse=True)
        # rows come from the free end upwards; counted from the top, so that the line runs downwards
        self.row_of = len(rows) - 1 - self.row_of
        # 0 at the clamp, 1 at the free end
        self.fraction = (GATE_LENGTH - rows[::-1]) / GATE_LENGTH
        self.count = np.bincount(self.row_of)

    def place(self, frame, points):
        """Of points (n, 2): distance (n,) to the line, side (n,) +1 or -1, fraction (n,) of the
        gate's length."""
        rubber = frame.of_types(RUBBER, CLAMPED)
        line = np.column_stack([np.bincount(self.row_of, rubber[name]) / self.count
                                for name in "xy"])
        reach = 3.0 * GATE_THICKNESS
        near = np.all((points > line.min(axis=0) - reach) & (points < line.max(axis=0) + reach),
                      axis=1)
        distance, side = np.full(len(points), np.inf), np.zeros(len(points), int)
        fraction = np.full(len(points), np.nan)
        if near.any():
            distance[near], side[near], where = project_on_polyline(points[near], line)
            fraction[near] = np.interp(where, np.arange(len(line)), self.fraction)
        return distance, side, fraction


def count_leaks(frames, spacing, log):
    """Number of water particles that pass a wall or the gate, and IDs of those that leave at the
    far end; frames: all, an iterable."""
    leaks, outflow = Leaks(0.5 * spacing), []
    midline = before = None
    for frame in frames:
        midline = midline or Midline(frame)
        water = frame.of_types(WATER)
        leaks.see(water)
        leaks.beyond_walls(water, [("x", 0.0, -1), ("y", 0.0, -1)])

        in_wall = (water["x"] > GATE_FACE + leaks.margin) & (water["x"] < GATE_FACE + GATE_THICKNESS
                                                             - leaks.margin)
        leaks.add(water, in_wall & (water["y"] > WALL_FROM))

        distance, side, fraction = midline.place(frame, water.vector("xy"))
        # away from the clamp's corner and from the free end, which water may round
        beside = (fraction > 0.05) & (fraction < 0.9) & (distance < 2.5 * GATE_THICKNESS)
        leaks.add(water, beside & (distance < 0.25 * GATE_THICKNESS))

        now = {"id": water["id"], "x": water["x"], "y": water["y"],
               "side": np.where(beside, side, 0),
               "vx": water["vx"], "time": frame.time}
        if before is not None:
            gone = ~np.isin(before["id"], now["id"], assume_unique=True)
            # twice the way to the next frame
            reach = before["x"] + 2.0 * before["vx"] * (now["time"] - before["time"])
            outflow += before["id"][gone & (reach > FAR_END)].tolist()
            _, new, old = np.intersect1d(now["id"], before["id"], assume_unique=True,
                                         return_indices=True)
            crossed = np.zeros(len(water), bool)
            crossed[new] = now["side"][new] * before["side"][old] < 0
            crossed[new] |= _crosses_wall(before["x"][old], before["y"][old], now["x"][new],
                                          now["y"][new])
            leaks.add(water, crossed)
        before = now
    return leaks.count(log, len(outflow)), outflow


def _crosses_wall(x0, y0, x1, y1):
    """Whether the way from (x0, y0) to (x1, y1), arrays (n,), crosses the wall above the gate."""
    crosses = (x0 - GATE_FACE) * (x1 - GATE_FACE) < 0.0
    share = np.divide(GATE_FACE - x0, x1 - x0, out=np.zeros_like(x0), where=crosses)
    return crosses & (y0 + share * (y1 - y0) > WALL_FROM)


def mass_error(log, first, last, outflow):
    """Relative change of the water's mass in the run but for particles `outflow`, from thermo if it
    has it, else of the number of particles."""
    mass = log.column("v_mass", "mass", "Mass")
    if mass is None:
        return abs(len(last) + len(outflow) - len(first)) / len(first)
    # particles start in equal cells, each with the mass of its density
    water = first.of_types(WATER)
    gone = np.sum(water["rho"][np.isin(water["id"], outflow)]) / np.sum(water["rho"])
    return abs(mass[-1] / mass[0] + gone - 1.0)


def rms(tip, name, experiment, column):
    """Distance [mm] to the experiment's points, those after the series' end left out; None if that
    leaves none."""
    def there(found, key):
        return series.Series({k: found[k][np.isfinite(found[key])] for k in ("time", key)})
    distance = series.rms_distance(there(tip, name), name, there(experiment, column), column)
    return None if distance is None else 1e3 * distance


def picture_tip(path, curves, experiment, codes=None):
    """Both displacements of the free end. curves: [(label, tip, colour, line style)]; codes: those
    of CODES, in grey."""
    with plot.picture(path, 6.4, 6.0) as figure:
        both = figure.subplots(2, 1, sharex=True)
        for axes, (name, column) in zip(both, COMPONENTS.items()):
            for code, (label, style) in CODES.items() if codes else ():
                axes.plot(codes.time, 1e3 * codes[f"{code}_{column}"], style, color=plot.GREY,
                          linewidth=1.0,
                          label=f"code: {label}")
            for label, tip, colour, style in curves:
                axes.plot(tip.time, 1e3 * tip[f"tip_{name}"], style, color=colour, label=label)
            axes.plot(experiment.time, 1e3 * experiment[column], "o", markersize=5,
                      markerfacecolor="white",
                      markeredgewidth=1.3, color="black", label="experiment, Antoci et al. 2007")
            axes.set_ylabel(f"{column} displacement [mm]")
        both[0].legend(fontsize=8, ncols=2, loc="lower center")
        both[1].set_xlabel("time [s]")
        both[1].set_xlim(0.0, None)
        figure.tight_layout()


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
    for name, column in COMPONENTS.items():
        summary.add(f"rms_{name}_experiment", rms(tip, f"tip_{name}", experiment, column), "mm")

    # one pass over a file that may be large; only the frames for the pictures are kept
    wanted = SNAPSHOT_TIMES if tip.time[-1] < 1.0 else LONG_TIMES
    kept, ends = {}, {}

    def passing():
        for frame in dump.frames(folder / "particles.dump"):
            ends.setdefault("first", frame)
            ends["last"] = frame
            for time in wanted:
                if time not in kept or abs(frame.time - time) < abs(kept[time].time - time):
                    kept[time] = frame
            yield frame

    values = summary.log.values
    first = next(dump.frames(folder / "particles.dump"))
    spacing = float(np.sqrt(WATER_AREA / len(first.of_types(WATER))))  # of the water
    leaked, outflow = count_leaks(passing(), spacing, summary.log)
    summary.add("particles_leaked", leaked)
    summary.add("outflow_particles", len(outflow))
    summary.add("mass_error", mass_error(summary.log, ends["first"], ends["last"], outflow))

    picture_tip(folder / "tip.png", [(_label(values), tip, plot.BLUE, "-")], experiment)
    shown = dump.nearest(list(kept.values()), wanted, tolerance=0.02)
    plot.snapshots(folder / "snapshots.png", shown, spacing, (WATER,), (RUBBER, CLAMPED),
                   limits=((-0.005, 0.3), (-0.005, 0.15)), columns=3 if len(shown) > 4 else 2)
    return summary.write()


def study(folder, runs):
    """Compares the runs {case: folder}: per modulus the resolutions with each other, the finest
    with experiment and codes."""
    folder = Path(folder)
    summary = Summary(folder)
    experiment, codes = series.read(HERE / "experiment.csv"), series.read(HERE / "codes.csv")
    # modulus -> runs of the total-Lagrangian gate, the coarsest first; runs of other forms of the
    # solid, with coarser water, in plane stress
    found, others, coarser, planes = {}, [], [], []
    for case, run in runs.items():
        if case != LONG:
            values = log.read(Path(run) / LOG_FILE).values
            tried = (others if _solid(values) != "tl" else planes if values.get("plane", "strain")
                     == "stress" else coarser if _coarser(values) > 1.0
                     else found.setdefault(_modulus(values), []))
            tried.append((values, series.read(Path(run) / "tip.csv"), Path(run)))

    for modulus, tried in sorted(found.items()):
        tried.sort(key=lambda run: run[0]["across"])
        _add_finest(summary, modulus, tried[-1][1], experiment, codes)
        for name in COMPONENTS:
            peaks = [run[1].peak(f"tip_{name}")[0] for run in tried]
            for (coarse, _, _), (fine, _, _), a, b in zip(tried, tried[1:], peaks, peaks[1:]):
                summary.add(
                    f"{modulus}_tip_{name}_peak_change_{coarse['across']:.0f}_to_"
                    f"{fine['across']:.0f}_across",
                    b / a - 1.0, target=CONVERGED)
    for values, tip, _ in others:
        same = [run[1] for run in found.get(_modulus(values), ()) if run[0]["across"]
                == values["across"]]
        for name in COMPONENTS if same else ():
            summary.add(
                f"{_modulus(values)}_{_solid(values)}_tip_{name}_peak_"
                f"{values['across']:.0f}_across",
                1e3 * tip.peak(f"tip_{name}")[0], "mm", 1e3 * same[0].peak(f"tip_{name}")[0],
                "our total-Lagrangian gate at this spacing")
    for values, tip, _ in coarser:
        same = [run[1] for run in found.get(_modulus(values), ()) if run[0]["across"]
                == values["across"]]
        for name in COMPONENTS if same else ():
            start = f"{_modulus(values)}_water_{_coarser(values):g}_times_coarser_tip_{name}"
            summary.add(f"{start}_peak", 1e3 * tip.peak(f"tip_{name}")[0], "mm",
                        1e3 * same[0].peak(f"tip_{name}")[0],
                        "our gate with one spacing", COARSER)
            summary.add(f"{start}_rms",
                        1e3 * series.rms_distance(tip, f"tip_{name}", same[0], f"tip_{name}"), "mm")
    for modulus, tried in sorted(found.items()):
        _add_codes(summary, modulus, tried[-1][1], codes)
    for values, tip, _ in planes:
        _add_codes(summary, f"{_modulus(values)}_plane_stress", tip, codes)
    summary.add("particles_leaked",
                sum(_figure(case, "particles_leaked") for case in summary.cases.values()), target=0)
    summary.add("mass_error", max(_figure(case, "mass_error") for case in summary.cases.values()),
                target=MASS_DIGITS)
    if LONG in runs:
        _add_long(summary, Path(runs[LONG]))

    colours = dict(zip(sorted(found), (plot.BLUE, plot.ORANGE)))
    picture_tip(folder / "tip.png",
                [(_label(tried[-1][0]), tried[-1][1], colours[modulus], "-")
                 for modulus, tried in sorted(found.items())] +
                [(_label(values), tip, colours.get(_modulus(values), plot.GREY), "--")
                 for values, tip, _ in others],
                experiment, codes)
    picture_tip(folder / "convergence.png",
                [(_label(values), tip, colours[modulus], style)
                 for modulus, tried in sorted(found.items())
                 for (values, tip, _), style in zip(reversed(tried), ("-", "--", "-.", ":"))],
                experiment)
    finest = min((run for tried in found.values() for run in tried),
                 key=lambda run: (run[0]["dx"], _modulus(run[0])))
    shutil.copyfile(finest[2] / "snapshots.png", folder / "snapshots.png")
    return summary.write()


def _add_finest(summary, modulus, tip, experiment, codes):
    """The finest run of a modulus beside experiment and codes."""
    for name, column in COMPONENTS.items():
        # no farther from the experiment than the nearest of the codes
        distances = {label: rms(codes, f"{code}_{column}", experiment, column)
                     for code, (label, _) in CODES.items()}
        summary.add(f"{modulus}_rms_{name}", rms(tip, f"tip_{name}", experiment, column), "mm",
                    None,
                    SOURCE + "; codes: "
                    + ", ".join(f"{label} {mm:.1f}" for label, mm in distances.items()),
                    min(distances.values()))
    for name, column in COMPONENTS.items():
        peak, time = tip.peak(f"tip_{name}")
        measured, measured_time = experiment.peak(column)
        summary.add(f"{modulus}_tip_{name}_peak", 1e3 * peak, "mm", 1e3 * measured, SOURCE,
                    PEAK_TARGET)
        summary.add(f"{modulus}_tip_{name}_peak_time", time, "s", measured_time, SOURCE)


def _add_codes(summary, start, tip, codes):
    """A run beside the other codes: its peaks in their range, a target with the original modulus in
    plane strain alone, and its distance to each."""
    peak, time = tip.peak("tip_x")
    for name, value, unit, which in (("x_peak", 1e3 * peak, "mm", 0), ("x_peak_time", time, "s", 1),
                                     ("y_peak", 1e3 * tip.peak("tip_y")[0], "mm", 2)):
        low, high = (pick(peaks[which] for peaks in CODE_PEAKS.values()) for pick in (min, max))
        middle = 0.5 * (low + high)
        summary.add(f"{start}_tip_{name}_in_codes", value, unit, middle,
                    f"codes: middle of their {low:g} to {high:g} {unit}",
                    (high - middle) / middle if start == "12MPa" else None)
    for code, (label, _) in CODES.items():
        summary.add(f"{start}_distance_x_{code}", rms(tip, "tip_x", codes, f"{code}_horizontal"),
                    "mm", 0, f"code, {label}")


def _add_long(summary, folder):
    """What is left after most of the water has gone."""
    tip = series.read(folder / "tip.csv")
    late = tip.time > tip.time[-1] - 0.5
    for name in COMPONENTS:
        summary.add(f"{LONG}_tip_{name}_end", 1e3 * np.mean(tip[f"tip_{name}"][late]), "mm", None,
                    "mean over the last 0.5 s")
    *_, last = dump.frames(folder / "particles.dump")
    water = last.of_types(WATER)
    summary.add(f"{LONG}_water_speed_end", float(np.sqrt(np.mean(water["vx"]**2 + water["vy"]**2))),
                "m/s", None, "root mean square")
    for name in ("outflow_particles", "particles_leaked", "mass_error"):
        summary.add(f"{LONG}_{name}", _figure(summary.cases[LONG], name))


def _modulus(values):
    """A run's modulus, as the material's name ends: 12MPa."""
    return values["rubber"].split("_")[-1]


def _solid(values):
    """The form of a run's solid, as the deck names it."""
    return values.get("solid", "tl")


def _coarser(values):
    """Spacing of a run's water over that of its rubber."""
    return values.get("coarser", 1.0)


def _label(values):
    form = {"tl": "", "ul": ", updated Lagrangian",
            "paper": ", updated, plain gradients"}[_solid(values)]
    form += ", plane stress" if values.get("plane", "strain") == "stress" else ""
    return f"{_modulus(values).replace('MPa', ' MPa')}, {values['across']:.0f} particles{form}"


def _figure(summary, name):
    return next(figure["value"] for figure in summary["figures"] if figure["name"] == name)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
