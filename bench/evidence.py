"""The three questions: what accuracy costs, which hard cases stay stable, what effects cost.
Pictures and pages, from the tables in doc."""

import json
import re
import textwrap

import effects
import numpy as np
from cost_report import curves_of, few_labels, one_curve, seconds
from tool import PAGE, read_csv

from fsi import paths, plot, results, scene

HARD = paths.ROOT / "doc" / "hard"
RECIPES = scene.analysis("hard").RECIPES
# scene: [(method of its sweep, what it is)]: the preset; delta-SPH as other codes have it; older
# SPH
COMPARED = {
    "elastic_gate": [("splash, water twice as coarse", "splash, solid/tl"),
                     ("delta-SPH", "delta-SPH")],
    "hydrostatic_plate": [("splash", "splash, solid/tl"), ("delta-SPH", "delta-SPH")],
    "oscillating_plate": [("TL quadratic, clamp at the face", "solid/tl"),
                          ("delta-SPH", "delta-SPH"), ("classic SPH", "classic SPH")],
    "standing_wave": [("quintic 1.0", "waves"), ("delta-SPH", "delta-SPH"),
                      ("classic SPH", "classic SPH")],
    "taylor_green": [("shifting, quintic 1.0", "closed"),
                     ("shifting, Wendland 1.5", "delta-SPH, shifting"),
                     ("classic SPH", "classic SPH")],
    "still_water": [("waves", "waves"), ("delta-SPH", "delta-SPH"), ("classic SPH", "classic SPH")],
    "turek_hron_fsi": [("four spacings, 2 to 8 particles", "four spacings"),
                       ("flag twice as fine as the water", "water of one spacing")]}
PANELS = list(COMPARED)[:6]
COLOURS = (plot.BLUE, plot.ORANGE, plot.GREY)
TITLES = {"elastic_gate": "Elastic gate: off its own finest run"}
BOUNDS = ("10", "2", "1")  # per cent
# effect: how fix fsi announces it, and what tools/cost effects calls it by scene
EFFECTS = {
    "artificial viscosity": (r"artificial viscosity of the fluid", {
        "fluid": "artificial viscosity", "gate": "artificial viscosity of the water"}),
    "laminar viscosity": (r"laminar viscosity", {"fluid": "laminar viscosity"}),
    "density diffusion": (r"density diffusion",
                          {"fluid": "density diffusion", "gate": "density diffusion"}),
    "particle shifting": (r"particle shifting", {"fluid": "shifting"}),
    "background pressure": (r"tension in|background", {"fluid": "tension, Tait, background"}),
    "mirror walls": (r"mirror walls", {"fluid": "mirror walls", "gate": "mirror walls"}),
    "walls of particles": (r"wall particles", {}),
    "coupling with solids": (r"coupling", {}),
    "hourglass control": (r"hourglass control",
                          {"total": "hourglass control", "gate": "hourglass control"}),
    "viscosity of the solid": (r"artificial viscosity of the solid", {
        "total": "artificial viscosity", "gate": "viscosity of the rubber"}),
    "solid sub-steps": (r"solid sub-steps", {"gate": "sub-steps"}),
    "plasticity": (r"plasticity", {"total": "plasticity (hypoelastic)"})}
ON = ("hourglass control",)  # without being named
# announcement, effect, its row then
SELDOM = (r"shifted every 4", "particle shifting", "shifting, every 4 steps")
# type of scene: a bundled one, scenes of tools/cost effects by which its effects are measured
TYPES = {
    "water at rest, waves": ("still_water", ("fluid",)), "dam break": ("dam_break", ("fluid",)),
    "vortices without walls": ("taylor_green", ("fluid",)),
    "flow past a rigid body": ("cylinder_channel", ("fluid",)),
    "elastic body": ("oscillating_plate", ("total",)),
    "bodies that collide": ("colliding_rings", ("total",)),
    "metal at impact": ("taylor_bar", ("total",)),
    "water on an elastic body": ("elastic_gate", ("gate", "fluid")),
    "elastic flag in a stream": ("turek_hron_fsi", ("gate", "fluid"))}


# ---- what accuracy costs ----

def summaries():
    """{scene: summary of its sweep}, as COMPARED orders them."""
    return {name: json.loads((PAGE / f"{name}.json").read_text()) for name in COMPARED}


def curves_in(name, summary):
    """[(rows, what they are)] of the methods that are compared in a scene."""
    curves = curves_of(read_csv(PAGE / f"{name}.csv"), [method for method, _ in COMPARED[name]],
                       summary["finer"])
    return [(curves[method], text) for method, text in COMPARED[name]]


def draw_cost(path):
    """Error over CPU seconds, a panel for each of PANELS."""
    _panels(path, PANELS, (2, 3), (8.0, 5.2), 9.5)


def draw_readme(path):
    """Two of the panels, in letters for a page that shows it at 800 pixels."""
    _panels(path, ("oscillating_plate", "taylor_green"), (1, 2), (5.0, 2.6), 9.5)


def _panels(path, names, shape, size, letters):
    found = summaries()
    with plot.picture(path, *size) as figure:
        for axes, name in zip(figure.subplots(*shape, squeeze=False).ravel(), names):
            axes.set(xscale="log", yscale="log")
            curves = [(curve, text, colour)
                      for (curve, text), colour in zip(curves_in(name, found[name]), COLOURS)
                      if curve]
            for curve, _, colour in curves:
                one_curve(axes, curve, np.array([r["cpu_seconds"] for r in curve]), colour)
            low, high = axes.get_ylim()
            axes.set_ylim(max(min(low, 0.3) / 1.5, 0.02), max(high, 20.0) * 8.0)
            axes.axhspan(1e-9, 1.0, color=plot.GREEN, alpha=0.12, linewidth=0)
            for k, (_, text, colour) in enumerate(curves):
                axes.text(0.98,
                          0.97 - 1.25 * k * letters / (72 * axes.get_position().height * size[1]),
                          text, transform=axes.transAxes, color=colour,
                          fontsize=letters, ha="right", va="top")
            few_labels(axes.xaxis)
            few_labels(axes.yaxis)
            axes.tick_params(labelsize=letters)
            axes.set_title(TITLES.get(name, found[name]["title"] + f": {quantity_of(found[name])}"),
                           loc="left", fontsize=letters)
            row = axes.get_subplotspec()
            if row.is_last_row():
                axes.set_xlabel("CPU seconds, one core", fontsize=letters)
            if row.is_first_col():
                axes.set_ylabel("error [%]", fontsize=letters)
        figure.tight_layout()


def quantity_of(summary):
    """What a sweep's error is an error of."""
    return summary["label"].removeprefix("error of the ").removeprefix("mean L1 error of the ")


def cost_table():
    """[[scene, its title, error of, what the method is, 10 %, 2 %, 1 %]]: CPU seconds of the
    coarsest run from which on a method keeps a bound."""
    rows = []
    for name, summary in summaries().items():
        at = "{:.3g} particles" if summary["resolution"].startswith(
            "particles") else f"{summary['variable']} = {{:.3g}}"
        for k, (method, text) in enumerate(COMPARED[name]):
            cells = []
            for bound in BOUNDS:
                entry = summary["methods"].get(method, {}).get("bounds", {}).get(bound)
                if entry is None or entry["kind"] == "extrapolated":
                    cells.append("none")
                else:
                    cells.append(
                        f"{'< ' * (entry['kind'] == 'coarsest run')}"
                        f"{seconds(entry['cpu_seconds'])} ({at.format(entry['at'])})")
            rows.append(["", "", "", text, *cells] if k
                        else [name, summary["title"], quantity_of(summary), text, *cells])
    return rows


def spread(name, method, sizes=None):
    """(least, largest) error of a method's runs [%], of those of given resolutions."""
    summary = json.loads((PAGE / f"{name}.json").read_text())
    curve = curves_of(read_csv(PAGE / f"{name}.csv"), [method], summary["finer"])[method]
    errors = [100 * abs(r["error"]) for r in curve if sizes is None or r["x"] in sizes]
    return min(errors), max(errors)


def flag():
    """What the elastic flag of FSI2 says, its runs with other speeds of sound and shifting among
    them."""
    one = [100 * abs(r["error"]) for r in read_csv(PAGE / "turek_hron_fsi.csv")
           if "four" not in r["label"] and r["error"] is not None]
    figures = results.scenes_of(paths.PAGE)["turek_hron_fsi"]["summary"]["figures"]
    amplitude = next(f for f in figures if f["name"] == "uy_amplitude_fsi2_2_to_8")
    one += [100 * abs(r["value"] / amplitude["reference"] - 1) for r in read_csv(PAGE / "sound.csv")
            if (r["scene"], r["figure"]) == ("turek_hron_fsi", "uy_amplitude")]
    return (f"In water of one spacing the elastic flag (FSI2) is {min(one):.0f} to {max(one):.0f} "
            "% off, as sound and shifting are chosen.",
            "Four spacings, finest at the flag, and twice the speed of sound bring it to "
            f"{100 * abs(amplitude['relative_error']):.1f} %.")


def beside(name, size):
    """Errors of the preset and of delta-SPH at a resolution."""
    here, delta = (spread(name, method, (size,))[0] for method, _ in COMPARED[name][:2])
    return f"{here:.2g} % here and {delta:.2g} % with delta-SPH"


def sentences():
    """What the sweeps say, with the numbers that they have."""
    found = summaries()
    plates = ("oscillating_plate", "hydrostatic_plate")
    best, delta = ([spread(name, COMPARED[name][k][0], (3, 4, 5)) for name in plates]
                   for k in (0, 1))
    still = [spread("taylor_green", f"{how}, quintic 1.0", (size,))[0] for size in (0.05, 0.02)
             for how in ("no shifting", "shifting")]
    gate = found["elastic_gate"]["reference"]
    total = sum(summary["points"] for summary in found.values())
    return [
        "Blue is the preset of the scene, orange delta-SPH, gray classic SPH, as in the [hard "
        "cases](../hard/README.md).",
        f"The dots are {_runs()} of {total} runs. The others change one setting at a time and are "
        "in the CSV file of each scene.",
        "Plates of three to five particles are within "
        f"{np.ceil(10 * max(b for _, b in best)) / 10:.1f} % with gradients that are exact for "
        "quadratic fields, the default.",
        "With the linear gradients of delta-SPH the same plates are "
        f"{min(a for a, _ in delta):.0f} to {max(b for _, b in delta):.0f} % off.",
        "The difference is small in a standing wave 10 rows deep: the period is off by "
        f"{beside('standing_wave', 0.05)}, whose error changes its sign there.",
        f"With 30 rows it is off by {beside('standing_wave', 0.0166666666667)}.",
        "It is also small in Taylor-Green vortices (L/50) if particles shift as in SPHinXsys: "
        f"{beside('taylor_green', 0.02)}.",
        f"Without shifting the error is {still[0] / still[1]:.0f} to {still[2] / still[3]:.0f} "
        "times as large at the same spacing.",
        f"Still water 20 rows deep is off by {beside('still_water', 0.025)}. As a hard case "
        "*waves* fails: its water keeps moving.",
        "In the elastic gate the preset's water is twice as coarse as the gate. "
        "The reference is an own run, uncertain by "
        f"{100 * gate['uncertainty'] / abs(gate['value']):.1g} %.",
        *flag(),
        "Your own input script gets the same: `tools/cost my_script.in --vary dx=0.1,0.05,0.025 "
        "--measure NAME`."]


def cost_page():
    """doc/cost/README.md."""
    lines = ["# What accuracy costs", "", "![Error over CPU time in six scenes](cost.png)", "",
             *(f"- {sentence}" for sentence in sentences()), "",
             "| scene | error of | scheme | 10 % | 2 % | 1 % |", "|---|---|---|---|---|---|"]
    lines += [f"| {f'[{title}]({name}.md)' if name else ''} | {' | '.join(cells)} |"
              for name, title, *cells in cost_table()]
    lines += ["", "CPU seconds on one core that keep an error bound; in brackets the resolution. "
              "So do all finer runs.",
              "`<`: the coarsest run keeps it. None: no run does, or the reference is not as "
              "certain.", "",
              "What [each effect](effects.md) adds to a step. [LAMMPS' own styles](peers.md) in "
              "comparison. [Several ranks](scaling.md).",
              "[How to choose](../choosing.md) resolution and effects.", "",
              "## How to read the pages", "",
              "- Green band: errors below 1 %. Open symbols: the error changes its sign there, so "
              "its size says nothing.",
              "- Time: CPU seconds of the time loop on one core. On a busy machine the same run "
              "takes up to twice as long. Settings are changed one at a time.",
              "- Bounds: as in the table above. *Slanted*: extrapolated. -: none.",
              "- Order: of convergence, by least squares with its 95 % interval. None: the "
              "interval contains 0."]
    return "\n".join(lines) + "\n"


def _runs():
    """How many dots the picture has."""
    found = summaries()
    return sum(len(curve) for name in PANELS for curve, _ in curves_in(name, found[name]))


# ---- which hard cases stay stable ----

def passed(entry, recipe):
    """Whether a row passes in a recipe; None if it was not run."""
    return entry[recipe]["pass"] if recipe in entry else None


def compared():
    """(hard.json, its rows that compare schemes, its rows that test software, {recipe: [whether
    each row passes]})."""
    found = json.loads((HARD / "hard.json").read_text())
    rows = [e for e in found["rows"] if e["scheme"]]
    return found, rows, [e for e in found["rows"] if not e["scheme"]], {
        recipe: [p for e in rows if (p := passed(e, recipe)) is not None] for recipe in RECIPES}


def scores():
    """How many rows pass, in a sentence."""
    *_, tried = compared()
    here, delta, classic = (f"{sum(tried[recipe])} of {len(tried[recipe])}" for recipe in RECIPES)
    return f"{here} hard cases pass here, {delta} with delta-SPH, {classic} with classic SPH."


def alone():
    """How many of the rows that add something to a preset pass without it, in a sentence."""
    tried = [p for e in compared()[1] if (p := passed(e, "preset")) is not None]
    return (f"Of the cases that add something to their preset, {sum(tried)} of {len(tried)} pass "
            "with the preset alone.")


# ---- what effects cost ----

def announced(name):
    """What fix fsi said to be on, from a scene's reference log."""
    path = next(iter(sorted((paths.EXAMPLES / name).glob(f"log.*.{name}.1"))))
    return re.search(r"^FSI: .*\n  on: *\n((?:    .*\n)+)  off", path.read_text(), re.M)[1]


def matrix():
    """[(type, {effect: added instructions or None where that was not measured}, over what)] of
    TYPES."""
    measured = {(r["scene"], r["effect"]): r["instructions"]
                for r in read_csv(PAGE / "effects.csv")}
    found = []
    for kind, (name, tables) in TYPES.items():
        on, added = announced(name), {}
        for effect, (pattern, rows) in EFFECTS.items():
            if not re.search(pattern, on):
                continue
            row = next(((table, rows[table]) for table in tables if table in rows), None)
            if effect == SELDOM[1] and re.search(SELDOM[0], on):
                row = ("fluid", SELDOM[2])
            added[effect] = measured[row] if row else None
        found.append((kind, added, "bare solid" if tables == ("total",) else "bare water"))
    return found


def draw_named(path):
    """Types of scenes against effects: a dot where the type names it."""
    rows = matrix()
    with plot.picture(path, 9.2, 4.8) as figure:
        axes = figure.add_axes((0.19, 0.115, 0.625, 0.58))
        for k, (kind, added, over) in enumerate(rows):
            for effect, value in added.items():
                x = list(EFFECTS).index(effect)
                axes.plot(x, k, "o", markersize=18, color=plot.BLUE, markerfacecolor="white"
                          if value is None else plot.BLUE)
                if value is not None:
                    axes.text(x, k, f"{100 * value:+.0f}", ha="center", va="center", fontsize=7,
                              color="white")
            axes.text(len(EFFECTS) - 0.2,
                      k, f"+{100 * sum(v for v in added.values() if v):.0f} % over {over}",
                      va="center", ha="left", fontsize=8)
        axes.set(xlim=(-0.6, len(EFFECTS) - 0.4), ylim=(len(rows) - 0.4, -0.7))
        axes.set_yticks(range(len(rows)), [kind for kind, *_ in rows], fontsize=8.5)
        axes.xaxis.tick_top()
        axes.set_xticks(range(len(EFFECTS)),
                        [f"{name} (default)" if name in ON else name for name in EFFECTS],
                        rotation=50, ha="left", fontsize=8)
        axes.tick_params(length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.text(len(EFFECTS) - 0.2, -0.9, "instructions, in all", fontsize=8, ha="left",
                  weight="bold")
        figure.text(0.5, 0.045,
                    "not named, besides the defaults:   +0 instructions   +0 bytes   +0 messages",
                    ha="center", fontsize=11, weight="bold", color="white",
                    bbox={"facecolor": plot.GREEN, "edgecolor": "none",
                          "boxstyle": "round,pad=0.5"})


# ---- the page of all three ----

def unstable():
    """What is not stable or not accurate, a line each. The first and the last quote data."""
    two = _curve("elastic_gate", "TL")[0.0025]  # two particles in 5 mm
    coarsest = min(x for x, r in _curve("oscillating_plate",
                                        "UL quadratic, hourglass, clamp at the face").items()
                   if r["status"] == "ok")
    return [f"Two particles through the thickness: the gate bends {-100 * two['error']:.0f} % too "
            "little, and water may leak through it. Take three or more.",
            "Thin free edges: single water particles may pass an edge that is thinner than the "
            "kernel's support.",
            "Two open ends with given pressures that swing: bursts of inflow, rare and short, in "
            "runs of more than 20 s.",
            "Updated-Lagrangian solids lock near Poisson's ratio 1/2 and stop when coarse: the "
            "elastic plate with fewer than "
            f"{coarsest:.0f} particles through the thickness."]


def _curve(name, method):
    """{resolution: row} of a method's curve in the table of a sweep."""
    return {r["x"]: r for r in read_csv(PAGE / f"{name}.csv") if r["role"] == "curve" and r["group"]
            == method}


def page():
    """doc/src/evidence.rst."""
    lines = [".. Written by tools/renew; edits are lost.", "", "Evidence: three questions",
             "=========================", "",
             "What accuracy costs", "-------------------", "", ".. image:: ../cost/cost_readme.png",
             "   :alt: Error over CPU time in two scenes",
             "   :target: ../cost/README.html", "",
             "Blue is the preset of the scene, orange delta-SPH as other codes have it, gray "
             "classic SPH. The green band marks errors below 1 %.",
             *flag(), "All scenes: :doc:`cost <../cost/README>`.", "",
             "Which hard cases stay stable", "----------------------------", "",
             ".. image:: ../hard/hard_readme.png",
             "   :alt: Two hard cases: here, with delta-SPH, with classic SPH",
             "   :target: ../hard/README.html", "",
             scores(), alone(), "All cases: :doc:`hard cases <../hard/README>`.", "",
             "What effects cost", "-----------------", "", ".. image:: ../cost/named.png",
             "   :alt: Types of scenes and the effects that they name",
             "   :target: ../cost/effects.html", "",
             "A dot stands where the scene of a type names an effect. Its number is the "
             "instructions that the effect adds, in per cent of the bare scene.",
             *textwrap.wrap(
                 "Besides the defaults an effect that a script does not name adds no instruction, "
                 f"byte or message. On by default: {effects.DEFAULTS}.".replace("`", "``"), 140),
             "``unittest/tools/test_pay.py`` tests each of the three. All effects: :doc:`effects "
             "<../cost/effects>`."]
    return "\n".join(lines) + "\n"
