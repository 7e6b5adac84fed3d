"""The three questions: what accuracy costs, which hard cases stay stable, what effects cost. Pictures and pages, from the tables in doc."""

import json
import re
import textwrap

import effects
import numpy as np
from cost_report import cheapest, curves_of, few_labels, one_curve, seconds
from tool import PAGE, read_csv

from fsi import paths, plot, results

HARD = paths.ROOT / "doc" / "hard"
# scene: method that its deck recommends, usual SPH in that scene and what is usual about it
COMPARED = {
    "elastic_gate": ("TL, water twice as coarse", "UL plain", "updated Lagrangian,\none run, not converged"),
    "hydrostatic_plate": ("quadratic", "linear", "linear gradients"),
    "oscillating_plate": ("TL quadratic, clamp at the face", "UL plain", "updated Lagrangian"),
    "turek_hron_fsi": ("four spacings, 2 to 8 particles", "flag twice as fine as the water", "water of one spacing"),
    "standing_wave": ("quintic 1.0", "cubic 1.3", "cubic spline"),
    "taylor_green": ("shifting, quintic 1.0", "no shifting, quintic 1.0", "no shifting"),
    "still_water": ("quintic 0.94", "cubic 1.3", "cubic spline")}
BOUNDS = ("10", "2", "1")  # per cent
# effect: how fix fsi announces it, and what tools/cost effects calls it by scene
EFFECTS = {
    "artificial viscosity": (r"artificial viscosity of the fluid", {"fluid": "artificial viscosity", "gate": "artificial viscosity of the water"}),
    "laminar viscosity": (r"laminar viscosity", {"fluid": "laminar viscosity"}),
    "density diffusion": (r"density diffusion", {"fluid": "density diffusion", "gate": "density diffusion"}),
    "particle shifting": (r"particle shifting", {"fluid": "shifting"}),
    "background pressure": (r"tension in|background", {"fluid": "tension, Tait, background"}),
    "mirror walls": (r"mirror walls", {"fluid": "mirror walls", "gate": "mirror walls"}),
    "walls of particles": (r"wall particles", {}),
    "coupling with solids": (r"coupling", {}),
    "hourglass control": (r"hourglass control", {"total": "hourglass control", "gate": "hourglass control"}),
    "viscosity of the solid": (r"artificial viscosity of the solid", {"total": "artificial viscosity", "gate": "viscosity of the rubber"}),
    "solid sub-steps": (r"solid sub-steps", {"gate": "sub-steps"}),
    "plasticity": (r"plasticity", {"total": "plasticity (hypoelastic)"})}
ON = ("hourglass control",)  # without being named
SELDOM = (r"shifted every 4", "particle shifting", "shifting, every 4 steps")  # announcement, effect, its row then
TYPES = {  # type of scene: a bundled one, scenes of tools/cost effects by which its effects are measured
    "water at rest, waves": ("still_water", ("fluid",)), "dam break": ("dam_break", ("fluid",)), "vortices without walls": ("taylor_green", ("fluid",)),
    "flow past a rigid body": ("cylinder_channel", ("fluid",)), "elastic body": ("oscillating_plate", ("total",)),
    "bodies that collide": ("colliding_rings", ("total",)), "metal at impact": ("taylor_bar", ("total",)),
    "water on an elastic body": ("elastic_gate", ("gate", "fluid")), "elastic flag in a stream": ("turek_hron_fsi", ("gate", "fluid"))}


# ---- what accuracy costs ----

def summaries():
    """{scene: summary of its sweep}, as COMPARED orders them."""
    return {name: json.loads((PAGE / f"{name}.json").read_text()) for name in COMPARED}


def draw_cost(path):
    """Error over CPU seconds, a panel a scene, the recommended method and usual SPH."""
    with plot.picture(path, 11.0, 5.4) as figure:
        panels = figure.subplots(2, 4).ravel()
        for axes, (name, summary) in zip(panels, summaries().items()):
            best, usual, why = COMPARED[name]
            curves = curves_of(read_csv(PAGE / f"{name}.csv"), [best, usual], summary["finer"])
            axes.set(xscale="log", yscale="log")
            for method, colour, text, side in ((best, plot.BLUE, "recommended", -1), (usual, plot.ORANGE, why, 1)):
                if curve := curves.get(method):
                    one_curve(axes, curve, np.array([r["cpu_seconds"] for r in curve]), colour)
                    _name(axes, curve, text, colour, side)
            low, high = axes.get_ylim()
            axes.set_ylim(min(low, 0.3) / 1.5, max(high, 20.0) * 1.8)
            axes.axhspan(1e-9, 1.0, color=plot.GREEN, alpha=0.12, linewidth=0)
            left, right = axes.get_xlim()
            axes.set_xlim(left / 1.6, right * 1.6)
            few_labels(axes.xaxis)
            few_labels(axes.yaxis)
            axes.tick_params(labelsize=7.5)
            axes.set_title(summary["title"].replace("Elastic flag behind a cylinder", "Elastic flag"), loc="left", fontsize=8.5)
        for axes in panels[3:7]:
            axes.set_xlabel("CPU seconds, one core", fontsize=8)
        for axes in panels[::4]:
            axes.set_ylabel("error [%]")
        panels[7].axis("off")
        panels[7].text(0.0, 0.95, "Each dot is a run, finer to the right.\n\nGreen: error below 1 %.\n\nBlue: the recommended method.\n\n"
                       "Orange: what is usual in SPH,\nin the same scene.\n\nOpen: the error changes its sign.", va="top", fontsize=8.5)
        figure.tight_layout()


def _name(axes, curve, text, colour, side):
    """The name of a curve above or below its last run."""
    last = curve[-1]
    axes.annotate(text, (last["cpu_seconds"], 100 * abs(last["error"])), (6, (11 if "\n" not in text else 20) * side), textcoords="offset points", color=colour, fontsize=7.5,
                  ha="right", va="center", zorder=2.5, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.5})


def cost_table():
    """[[scene, error of, 10 %, 2 %, 1 %]]: CPU seconds of the cheapest method that keeps a bound, and its resolution."""
    rows = []
    for name, summary in summaries().items():
        cells = []
        for bound in BOUNDS:
            found = cheapest(summary, bound)
            at = "{:.3g} particles" if summary["resolution"].startswith("particles") else f"{summary['variable']} = {{:.3g}}"
            text = "none" if found is None else f"{seconds(found[1]['cpu_seconds'])} ({at.format(found[1]['at'])})"
            cells.append(f"< {text}" if found and found[1]["kind"] == "coarsest run" else text)
        rows.append([summary["title"], name, summary["label"].removeprefix("error of the ").removeprefix("mean L1 error of the "), *cells])
    return rows


def spread(scene, method, sizes=None):
    """(least, largest) error of a method's runs [%], of those of given resolutions."""
    summary = json.loads((PAGE / f"{scene}.json").read_text())
    curve = curves_of(read_csv(PAGE / f"{scene}.csv"), [method], summary["finer"])[method]
    errors = [100 * abs(r["error"]) for r in curve if sizes is None or r["x"] in sizes]
    return min(errors), max(errors)


def sentences():
    """What the sweeps say, with the numbers that they have."""
    found = summaries()
    plates = [("oscillating_plate", "TL quadratic, clamp at the face", "TL linear, clamp at the face"), ("hydrostatic_plate", "quadratic", "linear")]
    best = max(spread(scene, method, (3, 4, 5))[1] for scene, method, _ in plates)
    linear = [spread(scene, method, (3, 4, 5)) for scene, _, method in plates]
    figures = results.scenes_of(paths.PAGE)["turek_hron_fsi"]["summary"]["figures"]
    amplitude = next(f for f in figures if f["name"] == "uy_amplitude_fsi2_2_to_8")
    still = [spread("taylor_green", f"{how}, quintic 1.0", (size,))[0] for size in (0.05, 0.02) for how in ("no shifting", "shifting")]
    flag = [spread("turek_hron_fsi", method) for method in ("flag twice as fine as the water", "one spacing")]
    gate = found["elastic_gate"]["reference"]
    wave = cheapest(found["standing_wave"], "1")
    total = sum(summary["points"] for summary in found.values())
    return [
        "Each panel shows how the error of one scene falls with CPU time, with the recommended method and with what is usual in SPH.",
        f"The dots are {_runs()} of {total} runs. The others change one setting at a time and are in the CSV file of each scene.",
        f"Plates of three to five particles are within {best:.1f} % with gradients that are exact for quadratic fields, the default.",
        f"With linear gradients the same plates are {min(a for a, _ in linear):.0f} to {max(b for _, b in linear):.0f} % off.",
        f"Vortices need particle shifting. Without it the error is {still[0] / still[1]:.0f} to {still[2] / still[3]:.0f} times as large at the same spacing.",
        f"A standing wave keeps 1 % in {seconds(wave[1]['cpu_seconds'])}, at a spacing of {wave[1]['at']:g} m for 0.5 m of water.",
        "In water at rest the kernel decides: only the quintic spline gets below 1 %.",
        f"The elastic gate is judged by its own finest run, which is uncertain by {100 * gate['uncertainty'] / abs(gate['value']):.1g} %.",
        f"In water of one spacing the elastic flag (FSI2) stays {min(a for a, _ in flag):.0f} to {max(b for _, b in flag):.0f} % off. "
        f"Four spacings, finest at the flag, and twice the speed of sound bring it to {100 * abs(amplitude['relative_error']):.1f} %.",
        "Your own input script gets the same: `tools/cost my_deck.in --vary dx=0.1,0.05,0.025 --measure NAME`."]


def cost_page():
    """doc/cost/README.md."""
    lines = ["# What accuracy costs", "", "![Error over CPU time in seven scenes](cost.png)", "", *(f"- {sentence}" for sentence in sentences()), "",
             "| scene | error of | 10 % | 2 % | 1 % |", "|---|---|---|---|---|"]
    lines += [f"| [{title}]({name}.md) | {what} | {' | '.join(cells)} |" for title, name, what, *cells in cost_table()]
    lines += ["", "CPU seconds on one core that keep an error bound, with the cheapest method; in brackets its resolution. All finer runs keep the bound, too.",
              "`<`: the coarsest run keeps it. None: no run does, or the reference is not as certain.", "",
              "What [each effect](effects.md) adds to a step. [LAMMPS' own styles](peers.md) in comparison. [Several ranks](scaling.md).",
              "[How to choose](../choosing.md) resolution and effects."]
    return "\n".join(lines) + "\n"


def _runs():
    """How many dots the picture has."""
    return sum(len(curve) for name, summary in summaries().items()
               for curve in curves_of(read_csv(PAGE / f"{name}.csv"), [m for m in COMPARED[name][:2] if m], summary["finer"]).values())


# ---- what effects cost ----

def announced(scene):
    """What fix fsi said to be on, from a scene's reference log."""
    path = next(iter(sorted((paths.EXAMPLES / scene).glob(f"log.*.{scene}.1"))))
    return re.search(r"^FSI: .*\n  on: *\n((?:    .*\n)+)  off", path.read_text(), re.M)[1]


def matrix():
    """[(type, {effect: added instructions or None where that was not measured}, over what)] of TYPES."""
    measured = {(r["scene"], r["effect"]): r["instructions"] for r in read_csv(PAGE / "effects.csv")}
    found = []
    for kind, (scene, tables) in TYPES.items():
        on, added = announced(scene), {}
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
                axes.plot(x, k, "o", markersize=18, color=plot.BLUE, markerfacecolor="white" if value is None else plot.BLUE)
                if value is not None:
                    axes.text(x, k, f"{100 * value:+.0f}", ha="center", va="center", fontsize=7, color="white")
            axes.text(len(EFFECTS) - 0.2, k, f"+{100 * sum(v for v in added.values() if v):.0f} % over {over}", va="center", ha="left", fontsize=8)
        axes.set(xlim=(-0.6, len(EFFECTS) - 0.4), ylim=(len(rows) - 0.4, -0.7))
        axes.set_yticks(range(len(rows)), [kind for kind, *_ in rows], fontsize=8.5)
        axes.xaxis.tick_top()
        axes.set_xticks(range(len(EFFECTS)), [f"{name} (default)" if name in ON else name for name in EFFECTS], rotation=50, ha="left", fontsize=8)
        axes.tick_params(length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
        axes.text(len(EFFECTS) - 0.2, -0.9, "instructions, in all", fontsize=8, ha="left", weight="bold")
        figure.text(0.5, 0.045, "not named, besides the defaults:   +0 instructions   +0 bytes   +0 messages", ha="center", fontsize=11, weight="bold", color="white",
                    bbox={"facecolor": plot.GREEN, "edgecolor": "none", "boxstyle": "round,pad=0.5"})


# ---- the page of all three ----

def unstable():
    """What is not stable or not accurate, a line each. The first and the last quote data."""
    two = _curve("elastic_gate", "TL")[0.0025]  # two particles in 5 mm
    coarsest = min(x for x, r in _curve("oscillating_plate", "UL quadratic, hourglass, clamp at the face").items() if r["status"] == "ok")
    return [f"Two particles through the thickness: the gate bends {-100 * two['error']:.0f} % too little, and water may leak through it. Take three or more.",
            "Thin free edges: single water particles may pass an edge that is thinner than the kernel's support.",
            "Two open ends with given pressures that swing: bursts of inflow, rare and short, in runs of more than 20 s.",
            "Updated-Lagrangian solids lock near Poisson's ratio 1/2 and stop when coarse: the elastic plate with fewer than "
            f"{coarsest:.0f} particles through the thickness."]


def _curve(scene, method):
    """{resolution: row} of a method's curve in the table of a sweep."""
    return {r["x"]: r for r in read_csv(PAGE / f"{scene}.csv") if r["role"] == "curve" and r["group"] == method}


def page():
    """doc/src/evidence.rst."""
    hard = json.loads((HARD / "hard.json").read_text())["rows"]
    here = [e["best"]["pass"] for e in hard if "best" in e]
    classic = [e["paper"]["pass"] for e in hard if "paper" in e]
    lines = [".. Written by tools/renew; edits are lost.", "", "Evidence: three questions", "=========================", "",
             "What does accuracy cost? Do hard cases stay stable? Do I pay for effects that I do not use?",
             "Each answer is one picture of measured data. ``tools/renew`` makes them; each data file names its commit.", "",
             "What accuracy costs", "-------------------", "", ".. image:: ../cost/cost.png", "   :alt: Error over CPU time in seven scenes",
             "   :target: ../cost/README.html", "",
             "Blue is the recommended method, orange what is usual in SPH. The green band marks errors below 1 %.", "",
             sentences()[-2],
             "The :doc:`page of all sweeps <../cost/README>` has the CPU seconds that errors of 10, 2 and 1 % cost in each scene, and how to get them for",
             "your own input script.", "",
             "Which hard cases stay stable", "----------------------------", "", ".. image:: ../hard/hard.png",
             "   :alt: Hard cases, here and with classic SPH", "   :target: ../hard/README.html", "",
             f"Of {len(here)} cases on which SPH codes commonly fail, {sum(here)} pass here. With classic SPH {sum(classic)} of {len(classic)} pass.",
             "The :doc:`page of hard cases <../hard/README>` has the bounds, the measured values and what is *not* stable.", "",
             "What effects cost", "-----------------", "", ".. image:: ../cost/named.png", "   :alt: Types of scenes and the effects that they name",
             "   :target: ../cost/effects.html", "",
             "A dot stands where the bundled scene of a type names an effect, as *fix fsi* prints it at the start of a run.",
             "The numbers are instructions that the effect adds to a step, in per cent of the bare scene. Open dots were not measured on their own.", "",
             *textwrap.wrap(f"Besides the defaults an effect that a script does not name is not computed, not stored and not sent. On by default: {effects.DEFAULTS}.".replace("`", "``"), 140), "",
             "- +0 instructions: the bare scene runs no function of an effect that is neither named nor a default. Counted by valgrind, to 0.2 %.",
             "- +0 bytes: a particle takes what the bare loops and each named effect need, counted by hand.",
             "- +0 messages: what two ranks send is counted around the MPI calls and equals a count by hand.", "",
             "``unittest/tools/test_pay.py`` tests each of the three. What each effect adds is on the page of",
             ":doc:`effects <../cost/effects>`."]
    return "\n".join(lines) + "\n"
