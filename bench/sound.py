"""What the numerical speed of sound changes: tools/cost sound [SCENE ...] [out=FOLDER]

Five bundled scenes, coarse, at 10, 20 and 40 times their largest speed of flow (valve and flag at
10 and 20), one core. Only the speed of sound differs from row to row, and the time step with it:
what acts in proportion to it (artificial viscosity, shifting) is divided by the ratio where a deck
has a variable for it. doc/choosing.md shows its table, which is in doc/cost. What has been run is
not run again.
"""

from tool import Job, figures_of, left, say

from fsi import scene, sweep
from fsi.command import Refusal, start

# scene: what it is, its settings, the variable and its value at 10 times the speed of flow,
# {variable over the ratio: value at 10}, ratios, {figure: what it is}
SCENES = {
    "elastic_gate": ("dam break with an elastic gate, 3 particles through it",
                     {"dx": 0.0016666666667, "tend": 0.2}, "c", 16.57, {}, (1, 2, 4),
                     {"tip_x_peak": "largest displacement [mm]",
                      "tip_x_peak_time": "time of it [s]"}),
    "valve": ("two leaflets, 20 rows", {"rows": 20}, "c", 5, {"alpha": 0.02, "shift": 0.16}, (1, 2),
              {"forward_1": "first pulse: flow forward [mm^2]",
               "opening_1": "largest distance of the tips [mm]",
               "forward_2": "second pulse: flow forward [mm^2]",
               "opening_2": "largest distance of the tips [mm]"}),
    "ring_annulus": ("ring in an annulus, added mass 1", {"across": 4, "density": 140}, "c", 20, {},
                     (1, 2, 4),
                     {"frequency": "frequency [rad/s]",
                      "damping_a_period": "amplitude lost in a period"}),
    "wedge_entry": ("wedge of 30 degrees, keel 16 dx deep", {"dx": 0.00625}, "mach", 30,
                    {"alpha": 0.1}, (1, 2, 4),
                    {"force": "force over rho V^3 t", "peak_pressure":
                         "peak pressure over rho V^2/2", "force_scatter": "scatter of the force"}),
    "turek_hron_fsi": ("flag behind a cylinder, FSI2, 10 particles per diameter",
                       {"benchmark": "fsi2", "length": 1.5, "finer": 2}, "mach", 10,
                       {"shift": 0.25}, (1, 2),
                       {"uy_amplitude": "amplitude across [mm]", "frequency": "frequency [Hz]",
                        "drag_mean": "mean drag [N/m]"}),
}
COLUMNS = ["scene", "times", "figure", "value", "change", "seconds"]
TARGET = 0.03  # of a figure from 10 to 20


def settings_of(name, ratio):
    """{variable of the scene's deck: text} at a ratio to 10 times the speed of flow."""
    _, settings, variable, value, over, *_ = SCENES[name]
    return {k: str(v) for k, v in (settings | {variable: value * ratio}
                                   | {k: v / ratio for k, v in over.items()}).items()}


def measured(folder, name, ratio):
    """{figure: value} of a run at this ratio, its CPU seconds included: of the scene's own case
    where that is it."""
    settings = settings_of(name, ratio)
    if there := left(sweep.Deck(scene.deck(name)), name, settings):
        return figures_of(there)
    if scene.run(name, folder, 1, settings, borrowed=name):
        raise Refusal(f"{name} failed: {folder}")
    return figures_of(folder)


def rows_of(name, found):
    """The rows of a scene, from {ratio: {figure: value}}."""
    rows, before = [], {}
    for ratio, figures in found.items():
        for figure in SCENES[name][6]:
            value = figures[figure]
            rows.append({"scene": name, "times": 10 * ratio, "figure": figure, "value": value,
                         "change": value / before[figure] - 1.0 if figure in before else None,
                         "seconds": figures["cpu_seconds"]})
        before = figures
    return rows


def page(rows):
    """The table for a look; doc/choosing.md has what follows from it."""
    lines = ["# Speed of sound over the largest speed of the flow; in brackets the change from the "
             "column before", "",
             "| scene | figure | 10 | 20 | 40 |", "|---|---|---|---|---|"]
    for name, (title, *_, figures) in SCENES.items():
        for figure, text in figures.items():
            found = {row["times"]: row for row in rows if (row["scene"], row["figure"])
                     == (name, figure)}
            cells = [f"{row['value']:.4g}"
                     + ("" if row["change"] is None else f" ({100 * row['change']:+.1f} %)") if row
                     else "-"
                     for row in (found.get(times) for times in (10, 20, 40))]
            lines.append(f"| {title if figure == next(iter(figures)) else ''} | {text} | "
                         + " | ".join(cells) + " |")
    for name in SCENES:
        found = {row["times"]: row["seconds"] for row in rows if row["scene"] == name}
        if found:
            lines.append(f"| | time of `{name}` [s] | " + " | ".join(
                f"{found[t]:.0f}" if t in found else "-" for t in (10, 20, 40)) + " |")
    first = [row for row in rows if row["times"] == 20 and row["change"] is not None]
    within = sum(abs(row["change"]) <= TARGET for row in first)
    return "\n".join([*lines, "", f"From 10 to 20 times the flow {within} of {len(first)} figures "
                      f"change by less than {100 * TARGET:.0f} %."]) + "\n"


def main(arguments):
    """tools/cost sound"""
    job = Job("sound", arguments, words=tuple(SCENES))
    rows = []
    for name in job.chosen or SCENES:
        *_, ratios, _ = SCENES[name]
        found = {}
        for ratio in ratios:
            folder = job.folder / f"{name}_{10 * ratio}"
            found[ratio] = job.kept.get([name, ratio, settings_of(name, ratio)],
                                        lambda: measured(folder, name, ratio))  # noqa: B023
            say(f"{name} at {10 * ratio}: "
                + ", ".join(f"{figure} {found[ratio][figure]:.4g}" for figure in SCENES[name][6]))
        rows += rows_of(name, found)
    job.write(COLUMNS, rows, 5, page(rows))
    return 0


if __name__ == "__main__":
    start("cost", main)
