"""The pages of hard cases and of what a user changes first, with their pictures, from the tables in
doc/hard."""

import json

import matplotlib
import matplotlib.image
from evidence import HARD, RECIPES, alone, compared, passed, scores, unstable
from tool import read_csv

from fsi import plot, scene

quantity = scene.analysis("hard").quantity
ROBUST = HARD / "robustness.csv"
GOOD, BAD, NONE = "#4caf50", "#d9534f", "#e4e4e4"
MARK = {True: "✓", False: "✗", None: ""}
COLUMNS = [
    "- Here: the [preset](../src/pair_fsi_fluid.rst) or solid of the column *scheme*, with what "
    "the row adds to it. In brackets: the preset alone.",
    "- Delta-SPH: what SPHinXsys, TrixiParticles and DualSPHysics do today, with this package's "
    "keywords. It is not a run of those codes.",
    "  Water: as the preset *splash*, but with negative pressure. That is the Wendland kernel with "
    "h = 1.5 dx, *density/diffusion* 0.1,",
    "  *artificial/visc* 0.02, and no shifting. Solids: total Lagrangian, *gradient linear*, "
    "*hourglass* 0.1 (the penalty force of TrixiParticles),",
    "  plain volumes, sub-steps.",
    "- Classic SPH: cubic spline with h = 1.3 dx, continuity, *artificial/visc* 0.1, negative "
    "pressure (Monaghan 1994). Solids: updated Lagrangian,",
    "  plain gradients, *artificial/stress* 0.3 (Gray et al. 2001), whose whole stress acts on the "
    "water (Antoci et al. 2007)."]


def value(entry, recipe, figure):
    """The worst value of a figure in a row's recipe as text, and whether it keeps the bound; the
    messages are in hard.csv."""
    if recipe not in entry:
        return "not run"
    found = entry[recipe]
    if found["stopped"] and not found["pass"]:
        return f"stopped {MARK[False]}"
    worst = found["worst"].get(figure)
    return "-" if worst is None else f"{quantity(figure, worst, '')} {MARK[found['kept'][figure]]}"


def scheme(entry):
    """What a row's best recipe is, and whether its preset alone passes."""
    return entry["scheme"] + (f" ({entry['alone']}: {MARK[passed(entry, 'preset')]})"
                              if "preset" in entry else "")


def lines_of(entry, *columns):
    """A line of the table for each bound of a row; the case and the cells of `columns` in the
    first."""
    for k, (figure, bound) in enumerate(entry["bounds"].items()):
        first = [entry["case"], *(column(entry) for column in columns)] if k == 0 else [""] * (
            1 + len(columns))
        shown = RECIPES if entry["scheme"] else ("best",)
        yield (
            f"| {' | '.join([*first, bound, *(value(entry, recipe, figure) for recipe in shown)])} "
            "|")


def hard_page():
    """doc/hard/README.md."""
    found, rows, software, _ = compared()
    lines = ["# Hard cases", "", f"**{scores()}**", alone(), "",
             "![Hard cases: here, with delta-SPH, with classic SPH](hard.png)", "", *COLUMNS,
             "- All three have the same particles, start, settings and length of run. They are "
             "coarse: 1 to 37,000 particles.",
             f"- `tools/run hard` runs them all ({found['runs']} runs, "
             f"{found['cpu_seconds'] / 60:.0f} minutes on one core).",
             "- Set-ups are in [unittest/hard](../../unittest/hard/README.md), all values and "
             "messages in [hard.csv](hard.csv).",
             f"- {robust()}", "",
             "What is *not* stable or not accurate:", "", *(f"- {text}" for text in unstable()), "",
             f"| case | scheme | bound | {' | '.join(RECIPES.values())} |",
             "|---|---|---|---|---|---|"]
    lines += [line for e in rows for line in lines_of(e, scheme)]
    lines += ["", "The values are the worst of all runs of a case, in the unit of the bound.", "",
              "## Tests of the software", "",
               "| case | bound | here |", "|---|---|---|"]
    return "\n".join(lines + [line for e in software for line in lines_of(e)]) + "\n"


def draw_hard(path):
    """A traffic light for each case and recipe, and pictures of some of them."""
    found, rows, *_ = compared()
    shown = found["pictures"]
    with plot.picture(path, 9.6, 7.0) as figure:
        axes = figure.add_axes((0.375, 0.02, 0.15, 0.92))
        for k, entry in enumerate(rows):
            for column, recipe in enumerate(RECIPES):
                good = passed(entry, recipe)
                axes.plot(column, k, "o", markersize=11,
                          color={True: GOOD, False: BAD, None: NONE}[good])
                axes.text(column, k, MARK[good], ha="center", va="center", fontsize=8,
                          color="white", family="DejaVu Sans")
        axes.set(xlim=(-0.5, 2.5), ylim=(len(rows) - 0.4, -0.6))
        axes.set_yticks(range(len(rows)), [entry["case"].partition(":")[0] for entry in rows],
                        fontsize=9)
        axes.set_xticks(range(len(RECIPES)), [name.replace(" ", "\n").replace("-S", "-\nS")
                                              for name in RECIPES.values()], fontsize=9,
                        weight="bold")
        axes.xaxis.tick_top()
        axes.tick_params(length=0)
        axes.grid(False)
        for spine in axes.spines.values():
            spine.set_visible(False)
        if shown:
            _pictures(figure, found, [p["group"] for p in shown], (0.55, 0.02, 0.44, 0.92), 9)


def draw_readme(path):
    """Two of the pictures, in letters for a page that shows it at 800 pixels."""
    found, *_ = compared()
    with plot.picture(path, 5.0, 3.75) as figure:
        _pictures(figure, found, ("patch", "obstacle"), (0.01, 0.01, 0.98, 0.9), 11)


def _pictures(figure, found, groups, place, size):
    """Pictures of some groups, a row for each, a column for each recipe, in a part of a figure."""
    shown = [p for p in found["pictures"] if p["group"] in groups]
    whole = matplotlib.image.imread(HARD / "thumbnails.png")
    high, wide = whole.shape[0] // len(RECIPES), whole.shape[1] // len(found["pictures"])
    left, bottom, width, height = place
    across, down = width / len(RECIPES), height / len(shown)
    rows = {e["row"]: e for e in found["rows"]}
    for k, picture in enumerate(sorted(shown, key=lambda p: groups.index(p["group"]))):
        column = found["pictures"].index(picture)
        for n, (recipe, name) in enumerate(RECIPES.items()):
            good = passed(rows[picture["group"]], recipe)
            axes = figure.add_axes((left + n * across + 0.004, bottom + height - (k + 1) * down
                                    + 0.004, across - 0.008, down - 0.06))
            axes.imshow(whole[n * high:(n + 1) * high, column * wide:(column + 1) * wide],
                        aspect="equal", interpolation="antialiased")
            axes.set(xticks=[], yticks=[])
            for spine in axes.spines.values():
                spine.set(visible=True, color=GOOD if good else BAD, linewidth=2)
            stopped = rows[picture["group"]][recipe]["stopped"]
            axes.set_title(picture["title"] if n == 0
                           else f"stopped at {picture['times'][recipe]:.2g} s" if stopped else "",
                           fontsize=size, pad=3, loc="left")
            if k == 0:
                figure.text(left + (n + 0.5) * across, bottom + height + 0.035, name, ha="center",
                            fontsize=size, weight="bold")


# ---- what a user changes first ----

def robust():
    """A sentence on doc/hard/robustness.csv."""
    rows = read_csv(ROBUST)
    verdicts = [r["verdict"] for r in rows]
    failed = len(rows) - verdicts.count("sound") - verdicts.count("stopped")
    return (f"With other materials and spacings {verdicts.count('sound')} of {len(rows)} scenes "
            f"start soundly (400 steps), {verdicts.count('stopped')} stop with "
            f"their cause{f', {failed} fail without one' if failed else ''}: "
            "[robustness.csv](robustness.csv).")
