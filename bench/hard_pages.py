"""The pages of hard cases and of what a user changes first, with their pictures, from the tables in doc/hard."""

import json

import matplotlib
import numpy as np
from evidence import HARD, unstable
from tool import read_csv

from fsi import plot
from fsi.summary import number

LABELS = {"distance": "nearest pair / dx", "neighbours_kept": "first neighbors kept", "ke_over_pe": "kinetic / potential energy",
          "in_one_piece": "share in one piece", "pull": "pull [N/m]", "draft_error": "draft or gap off / dx", "mach": "v / c",
          "honest": "sound or stopped for the right cause", "pressure_error": "pressure error"}
GOOD, BAD, NONE = "#4caf50", "#d9534f", "#e4e4e4"
MARK = {True: "✓", False: "✗", None: ""}


def passed(entry, recipe):
    """Whether a row passes in a recipe; None if it was not run."""
    return entry[recipe]["pass"] if recipe in entry else None


def values(entry, recipe):
    """Measured values of a row's recipe as text, a run that was stopped as such; the messages are in hard.csv."""
    if recipe not in entry:
        return "not run"
    found = [f"{v:.3g}" if v < 1e4 else number(v) for v in entry[recipe]["worst"].values() if v is not None]
    return ", ".join(found + ["stopped"] * bool(entry[recipe]["stopped"] and not passed(entry, recipe))) or "-"


def bounds(entry):
    """The criterion as text, such as: nearest pair / dx > 0.5."""
    return "; ".join(f"{LABELS.get(figure, figure.replace('_', ' '))} {bound}" for figure, bound in entry["criterion"].items())


def hard_page():
    """doc/hard/README.md."""
    found = json.loads((HARD / "hard.json").read_text())
    rows = found["rows"]
    here, classic = ([p for e in rows if (p := passed(e, recipe)) is not None] for recipe in ("best", "paper"))
    lines = ["# Hard cases", "",
             f"**{sum(here)} of {len(here)} cases pass with the recommended scheme. {sum(classic)} of {len(classic)} pass with classic SPH.**", "",
             "![Hard cases, here and with classic SPH](hard.png)", "",
             "- Each case is a scene on which SPH codes commonly fail, with a bound on what it must keep.",
             "- Classic SPH: updated-Lagrangian solids with plain gradients and artificial stress, density of the fluid by summation, cubic spline.",
             "- All cases are coarse: 200 to 37,000 particles. They run in full with `tools/run hard`"
             f" ({found['runs']} runs, {found['cpu_seconds'] / 60:.0f} minutes on one core).",
             "- Set-ups and settings are in [unittest/hard](../../unittest/hard/README.md), all values and messages in [hard.csv](hard.csv).",
             "- Materials and spacings that a user changes first are on the page of [robustness](robustness.md).", "",
             "What is *not* stable or not accurate:", "", *(f"- {text}" for text in unstable()), "",
             "| case | bound | here | | classic SPH | |", "|---|---|---|---|---|---|"]
    lines += [f"| {e['case']} | {bounds(e)} | {values(e, 'best')} | {MARK[passed(e, 'best')]} | {values(e, 'paper')} | {MARK[passed(e, 'paper')]} |" for e in rows]
    lines += ["", "The values are the worst of all runs of a case, in the order of the bounds."]
    return "\n".join(lines) + "\n"


def draw_hard(path):
    """Two traffic lights for each case, and pictures of some of them, here above classic SPH."""
    found = json.loads((HARD / "hard.json").read_text())
    rows, shown = found["rows"], found["pictures"]
    with plot.picture(path, 9.6, 7.2) as figure:
        axes = figure.add_axes((0.395, 0.02, 0.11, 0.92))
        for k, entry in enumerate(rows):
            for column, recipe in enumerate(("best", "paper")):
                good = passed(entry, recipe)
                axes.plot(column, k, "o", markersize=10, color={True: GOOD, False: BAD, None: NONE}[good])
                axes.text(column, k, MARK[good], ha="center", va="center", fontsize=7.5, color="white", family="DejaVu Sans")
        axes.set(xlim=(-0.5, 1.5), ylim=(len(rows) - 0.4, -0.6))
        axes.set_yticks(range(len(rows)), [entry["case"] for entry in rows], fontsize=7)
        axes.set_xticks((0, 1), ("here", "classic SPH"), fontsize=8, weight="bold")
        axes.xaxis.tick_top()
        axes.tick_params(length=0)
        axes.grid(False)
        for spine in axes.spines.values():
            spine.set_visible(False)
        whole = matplotlib.image.imread(HARD / "thumbnails.png")
        high, wide = whole.shape[0] // 2, whole.shape[1] // len(shown)
        for k, picture in enumerate(shown):
            for row, (which, colour) in enumerate((("here", GOOD), ("classic", BAD))):
                place = figure.add_axes((0.56 + 0.225 * row, 0.765 - 0.187 * k, 0.20, 0.165))
                place.imshow(whole[row * high:(row + 1) * high, k * wide:(k + 1) * wide], aspect="auto", interpolation="antialiased")
                place.set(xticks=[], yticks=[])
                for spine in place.spines.values():
                    spine.set(visible=True, color=colour, linewidth=2)
                text = f"{picture['title']}, t = {picture[which]:.2g} s" if row == 0 else f"t = {picture[which]:.2g} s"
                stopped = row == 1 and picture["classic"] < 0.5 * picture["here"]
                place.set_title(text + (", stopped" if stopped else ""), fontsize=7, pad=2, loc="left")
        for x, text in ((0.66, "here"), (0.885, "classic SPH")):
            figure.text(x, 0.965, text, ha="center", fontsize=8, weight="bold")


# ---- what a user changes first ----

def robustness_page():
    """doc/hard/robustness.md."""
    rows = read_csv(HARD / "robustness.csv")
    stopped = [r for r in rows if r["verdict"] != "sound"]
    named = [r for r in stopped if r["verdict"] == "stopped"]
    lines = ["# Robustness", "", f"**{len(rows) - len(stopped)} of {len(rows)} runs are sound. {len(named)} are stopped with an error that names the cause.**"]
    if len(named) < len(stopped):
        lines += [f"{len(stopped) - len(named)} fail without one."]
    lines += ["", "![Scenes and changes: sound or stopped](robustness.png)", "",
              "- Each scene runs coarsely for some 400 steps: as it is, with other materials and with other spacings.",
              "- Sound: the run ends with finite values and speeds below that of sound, and no particle is lost.",
              "- 400 steps show that a run starts well. They do not show that it is accurate, nor that it stays stable for long.",
              "- All runs are in [robustness.csv](robustness.csv); `tools/cost robustness` makes them.", "",
              "| scene | change | cause of the stop |", "|---|---|---|"]
    lines += [f"| {r['scene']} | {r['change']} | {r['cause'].partition('. ')[0].replace('|', '/')} |" for r in stopped]
    return "\n".join(lines) + "\n"


def draw_robustness(path):
    """A field for each scene and change: green sound, yellow stopped, red failed, gray where there is no solid to change."""
    rows = read_csv(HARD / "robustness.csv")
    scenes, changes = (list(dict.fromkeys(r[key] for r in rows)) for key in ("scene", "change"))
    level = {"sound": 1, "stopped": 2}
    field = np.zeros((len(scenes), len(changes)))
    for r in rows:
        field[scenes.index(r["scene"]), changes.index(r["change"])] = level.get(r["verdict"], 3)
    with plot.picture(path, 6.4, 0.2 * len(scenes) + 1.3) as figure:
        axes = figure.add_subplot()
        axes.imshow(field, cmap=matplotlib.colors.ListedColormap(["#f2f2f2", GOOD, "#f0ad4e", BAD]), vmin=0, vmax=3, aspect="auto")
        axes.set_xticks(range(len(changes)), [change.replace("Poisson's ratio", "Poisson's\nratio").replace("spacing ", "spacing\n").replace("times ", "times\n")
                                              for change in changes], fontsize=8)
        axes.xaxis.tick_top()
        axes.set_yticks(range(len(scenes)), scenes, fontsize=7.5)
        axes.set_xticks(np.arange(len(changes) + 1) - 0.5, minor=True)
        axes.set_yticks(np.arange(len(scenes) + 1) - 0.5, minor=True)
        axes.grid(False)
        axes.grid(which="minor", color="white", linewidth=1.5)
        axes.tick_params(which="both", length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
        names = [matplotlib.patches.Patch(color=colour, label=text) for colour, text in
                 ((GOOD, "sound"), ("#f0ad4e", "stopped, cause named"), (BAD, "failed"), ("#f2f2f2", "no solid to change"))]
        axes.legend(handles=names, loc="upper center", bbox_to_anchor=(0.4, -0.01), ncols=4, fontsize=8)
        figure.tight_layout()
