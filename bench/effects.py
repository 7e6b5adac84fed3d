"""What each effect costs: time, instructions, memory and messages of a step with it, over those
without. tools/cost effects"""

import re

import measure
import solid_variants
from measure import write_materials
from tool import Job, say

from fsi import plot, scene
from fsi.command import Refusal, start

COLUMNS = ("scene", "effect", "time", "spread", "instructions", "memory", "messages", "bytes",
           "collectives")


# ---- scenes: functions of what is named; n particles along x, m along y ----

def _start(n, m, types=1):
    return f"""units si
dimension 2
boundary f f p
atom_style fsi
newton on
region box block -0.2 1.2 -0.2 1.2 -0.005 0.005
create_box {types} box
lattice sq {1 / n!r} origin 0.5 0.5 0
region body block 0 1 0 {m / n!r} INF INF units box
create_atoms 1 region body
variable vx atom 0.3*sin(6.2832*x)*cos(6.2832*y)
variable vy atom -0.3*cos(6.2832*x)*sin(6.2832*y)
velocity all set v_vx v_vy NULL
"""


def _end(n, commands, dt):
    return f"""{commands}
timestep {dt / n!r}
neighbor {0.4 / n!r} bin
neigh_modify every 1 delay 0 check yes
thermo 1000000
"""


def fluid(n, m, style="", sph="", commands="", walls=""):
    """A rectangle of water, swirling."""
    return _start(n, m) + f"""pair_style fsi/fluid sound 10 {style}
pair_coeff * * materials.fsi water
fix sph all fsi {1 / n!r} wendland 1.5 {sph}
fix gravity all gravity 9.81 vector 0 -1 0
{f'fix walls all fsi/wall/mirror xlo 0 xhi 1 ylo 0 yhi {m / n!r}' if walls else ''}
""" + _end(n, commands, 0.02)


def updated(n, m, style="", sph="", stress="", material="plate", commands="", bodies=1):
    """A plate, swirling, in updated-Lagrangian form."""
    body = ("set group all mol 1" if bodies == 1 else "region low block INF INF INF "
            f"{0.5 * m / n!r} INF INF\nset group all mol 1\nset region low mol 2")
    return _start(n, m) + f"""{body}
pair_style fsi/solid {style}
pair_coeff * * materials.fsi {material}
fix sph all fsi {1 / n!r} wendland 1.5 {sph}
fix stress all fsi/stress {stress}
""" + _end(n, commands, 0.004)


def total(n, m, style="", sph="", stress=None, material="plate", commands=""):
    """The same in total-Lagrangian form."""
    return _start(n, m) + f"""set group all mol 1
pair_style fsi/solid/tl {style}
pair_coeff * * materials.fsi {material}
fix sph all fsi {1 / n!r} wendland 1.5 {sph}
{'' if stress is None else f'fix stress all fsi/stress {stress}'}
""" + _end(n, commands, 0.004)


def gate(n, _, without=(), water="", rubber="", commands=""):
    """The bundled deck, n particles per metre, without its output, its balancing and some of its
    effects, with others."""
    text = scene.deck("elastic_gate").read_text()
    cut = {"viscosity": r" artificial/visc 0.05 0", "diffusion": r" density/diffusion 0.1",
           "walls": r"^fix +walls .*$",
           "rubber viscosity": r"(?<=fsi/solid/tl) artificial/visc 0.1 0",
           "output": r"^(dump|fix +tip|compute +(disp|last|previous|front|fields)|print"
           r"|variable +(tip_x|tip_y|front|reflected)|run|fix "
           r"+balance|thermo_style|thermo_modify|dump_modify|thermo) .*(\n[^\n]*title.*|\n +id "
           r"type.*)?$"}
    # the time step of the start, with a number of sub-steps that does not change: one run's
    # instructions are another's
    dx, n_sub = 1 / n, 1 if "substeps" in without else 8
    text = re.sub(r"^fix +dt .*$", f"timestep {0.375 * dx * n_sub / 153!r}",
                  re.sub(r"^(fix +sph .*)$", rf"\1 substeps {n_sub}", text, flags=re.M), flags=re.M)
    for part in ("output", *(part for part in without if part != "substeps")):
        text, count = re.subn(cut[part], "", text, flags=re.M)
        if not count:
            raise Refusal(f"the gate's deck has no '{cut[part]}' any more")
    text = text.replace('"fsi/fluid sound', f'"fsi/fluid {water} sound').replace(
        "fsi/solid/tl artificial", f"fsi/solid/tl {rubber} artificial")
    text = re.sub(r"^(variable +dx index) \S+", rf"\1 {1 / n!r}", text, flags=re.M)
    return text + f"{commands}\nthermo 1000000\n"


STEP = "fix dt all fsi/dt 10"
WATCH = "fix watch all fsi/watch 10 distance off density off energy off"
LEDGER = "compute ledger all fsi/energy\nthermo_style custom step c_ledger[1]"
DEFAULTS = ("*hourglass 0.05*, *gradient quadratic* and *volumetric auto* of `fsi/solid/tl`, "
            "*solid/guard 0.5* of `fsi/fluid`, "
            "*mach 1* of `fix fsi`")  # what is on without being named; their pages have it

SCENES = {  # scene: title, deck, {effect: settings with it, or (without, with)}
    "fluid": ("Water", fluid, {
        "artificial viscosity": {"style": "artificial/visc 0.05 0"},
        "laminar viscosity": {"style": "laminar/visc"},
        "laminar viscosity, central": {"style": "laminar/visc/central"},
        "density diffusion": {"style": "density/diffusion 0.1"},
        "shifting": {"style": "shift 0.1"},
        "shifting, every 4 steps": {"style": "shift 0.1 shift/every 4"},
        "mirror walls": {"walls": "yes"},
        "free-surface rule": {"style": "surface 0.9"},
        "density by summation": {"sph": "fluid summation"},
        "tension, Tait, background": {"style": "eos tait tension yes background 1"},
        "adaptive time step": {"commands": STEP},
        "monitor (fix fsi/watch)": {"commands": WATCH},
        "energy balance": ({"style": "artificial/visc 0.05 0"},
                           {"style": "artificial/visc 0.05 0", "commands": LEDGER})}),
    "updated": ("Solid, updated Lagrangian", updated, {
        "artificial viscosity": {"style": "artificial/visc 0.1 0"},
        "artificial stress": {"style": "artificial/stress 0.3"},
        "corrected gradients": {"style": "gradient corrected"},
        "quadratic gradients": {"style": "gradient quadratic"},
        "hourglass control": {"style": "hourglass 0.5"},
        "plasticity": {"stress": "plastic", "material": "metal"},
        "two bodies, contact": {"bodies": 2},
        "density by summation": {"sph": "solid summation"},
        "density by ratio": {"sph": "solid ratio"},
        "adaptive time step": {"commands": STEP},
        "monitor (fix fsi/watch)": {"commands": WATCH},
        "energy balance": {"commands": LEDGER}}),
    "total": ("Solid, total Lagrangian", total, {
        "artificial viscosity": {"style": "artificial/visc 0.1 0"},
        "hourglass control": ({"style": "hourglass 0"}, {}),
        "neo-Hookean": {"style": "law neohookean"},
        "hypoelastic": {"style": "law hypo", "stress": ""},
        "plasticity (hypoelastic)": {"style": "law hypo", "stress": "plastic", "material": "metal"},
        "damage": {"style": "damage 0.5"},
        "adaptive time step": {"commands": STEP},
        "monitor (fix fsi/watch)": {"commands": WATCH},
        "energy balance": {"commands": LEDGER}}),
    "gate": ("Elastic gate", gate, {
        "artificial viscosity of the water": ({"without": ("viscosity",)}, {}),
        "density diffusion": ({"without": ("diffusion",)}, {}),
        "mirror walls": ({"without": ("walls",)}, {}),
        "viscosity of the rubber": ({"without": ("rubber viscosity",)}, {}),
        "sub-steps": ({"without": ("substeps",)}, {}),
        "shifting": {"water": "shift 0.1"},
        "hourglass control": ({"rubber": "hourglass 0"}, {}),
        "damage": {"rubber": "damage 0.5"},
        "adaptive time step": {"commands": STEP},
        "monitor (fix fsi/watch)": {"commands": WATCH},
        "energy balance": {"commands": LEDGER}})}
# n, m of the timed and of the counted runs; elsewhere:
TIMED, COUNTED = {"gate": (1000, 0)}, {"gate": (400, 0)}
SIZE, SMALL, STEPS = (160, 100), (40, 25), {"fluid": 60, "updated": 60, "total": 120, "gate": 60}


def cases(name):
    """[(effect, settings without, settings with)] of a scene."""
    return [(label, *(change if isinstance(change, tuple) else ({}, change)))
            for label, change in SCENES[name][2].items()]


def deck(name, settings, size):
    """The input of one case, without run."""
    text = SCENES[name][1](*size, **settings)
    return text if name == "gate" else write_materials(text)


def rows_of(name, kept, turns):
    """The table of a scene."""
    small = [deck(name, s, COUNTED.get(name, SMALL)) for _, *both in cases(name) for s in both]
    say(f"cost: {SCENES[name][0]}: counting instructions of {len(small)} runs")
    counts = kept.get(["instructions", small], lambda: measure.instructions(small))
    # no list is rebuilt on the way
    still = [re.sub(r"^timestep .*", "timestep 1e-7", text, flags=re.M) for text in small]
    sent = kept.get(["messages", still], lambda: measure.messages(still))
    rows = []
    for k, (label, without, with_it) in enumerate(cases(name)):
        found = kept.pair(*(deck(name, s, TIMED.get(name, SIZE)) + f"\nrun {STEPS[name]}"
                            for s in (without, with_it)), turns)
        a, b = sent[2 * k], sent[2 * k + 1]
        row = {"scene": name, "effect": label, "time": found.ratio - 1, "spread": found.spread,
               "instructions": counts[2 * k + 1] / counts[2 * k] - 1, "memory": found.memory[1]
               - found.memory[0],
               "messages": b["messages"] - a["messages"], "bytes": (b["bytes"] - a["bytes"])
               / a["ghosts"],
               "collectives": b["collectives"] - a["collectives"]}
        say("cost:   {effect}: time {time:+.1%} ± {spread:.1%}, instructions {instructions:+.1%}, "
            "{memory:+.0f} B a particle, "
            "{messages:+.2g} messages and {bytes:+.1f} B a ghost".format(**row))
        rows.append(row)
    return rows


HIGHEST = 1.0  # where bars are cut


def draw(path, rows):
    """Instructions that each effect adds, the dearest first, a panel for each scene; cut at
    HIGHEST, where the number stands instead."""
    tables = [[r for r in rows if r["scene"] == name] for name in SCENES]
    with plot.picture(path, 9.6, 6.0) as figure:
        grid = figure.add_gridspec(2, 2, height_ratios=[max(len(t) for t in tables[:2]) + 2,
                                                        max(len(t) for t in tables[2:]) + 2])
        for place, name, table in zip(grid, SCENES, tables):
            axes = figure.add_subplot(place)
            table = sorted(table, key=lambda r: -r["instructions"])
            value = [min(r["instructions"], HIGHEST) for r in table]
            axes.barh(range(len(table)), [100 * v for v in value], 0.7,
                      color=[plot.GREEN if v < 0 else plot.BLUE for v in value])
            for k, row in enumerate(table):
                axes.text(100 * max(value[k], 0.0), k, f" {100 * row['instructions']:+.0f}" + " →"
                          * (row["instructions"] > HIGHEST), va="center", fontsize=7)
            axes.set_yticks(range(len(table)), [r["effect"] for r in table], fontsize=7.5)
            axes.set(xlim=(-12, 118), ylim=(len(table) - 0.4, -0.6),
                     xlabel="instructions added to a step [%]")
            axes.set_title(SCENES[name][0], loc="left", weight="bold")
            axes.axvline(0.0, color=plot.GREY, linewidth=0.8)
            axes.grid(axis="y", visible=False)
        figure.tight_layout()


def _added(value, form):
    """A number, empty where it is none."""
    return format(value, form) if value else ""


def page(rows, variants):
    """The page's text; variants: rows of tools/cost solids, of which the same in three dimensions;
    none while those are not there."""
    lines = ["# What each effect costs", "",
             "Besides the defaults an effect that a script does not name is not computed, stored "
             "or sent.", f"On by default: {DEFAULTS}.",
             "This is what naming an effect adds to a step.", "",
             "![Instructions that each effect adds](effects.png)", "",
             "- Instructions of the time loop are counted by valgrind. They do not depend on the "
             "machine's load. Bars are cut at 100 %.",
             "- Time: CPU time with the effect over that without, in turns in one process: median "
             "± half the range.",
             "- Memory: bytes of each particle. Messages and bytes: what one of two ranks sends in "
             "a step, bytes for each ghost particle. Empty: nothing.",
             "- The scenes are small: 1,000 particles. Walls are near many of them, and cost less "
             "in larger scenes.",
             "- The gate is the bundled one, solids included. There an effect of the water is a "
             "smaller share.", "",
             "| scene | effect | instructions | in 3D | time | memory [B] | messages | bytes | "
             "collective calls |", "|---|---|---:|---:|---:|---:|---:|---:|---:|"]
    for name, (title, *_) in SCENES.items():
        for k, r in enumerate(r for r in rows if r["scene"] == name):
            three = solid_variants.added(variants, 3, name, r["effect"])
            lines.append(f"| {'' if k else title} | {r['effect']} | {r['instructions']:+.1%} | "
                         f"{'' if three is None else f'{three:+.1%}'} | {r['time']:+.0%} ± "
                         f"{r['spread']:.0%} | "
                         f"{_added(r['memory'], '+.0f')} | {_added(r['messages'], '+.2g')} | "
                         f"{_added(r['bytes'], '+.1f')} | {_added(r['collectives'], '+.2g')} |")
    for what, (variant, over) in solid_variants.FORMS.items() if variants else ():
        two, three = (solid_variants.ratio(variants, dim, variant, over) - 1.0 for dim in (2, 3))
        lines.append(f"| Solid | {what} | {two:+.1%} | {three:+.1%} | | | | | |")
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost effects"""
    job = Job("effects", arguments, turns=3, words=SCENES)
    rows = [row for name in job.chosen or SCENES for row in rows_of(name, job.kept, job.turns)]
    draw(job.folder / "effects.png", rows)
    job.write(COLUMNS, rows, 5, page(rows, []))
    return 0


if __name__ == "__main__":
    start("cost", main)
