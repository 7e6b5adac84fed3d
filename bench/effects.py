"""What each effect costs: time, instructions, memory and messages of a step with it, over those without. tools/cost effects"""

import re

import measure
from measure import write_materials
from tool import Job, say

from fsi import plot, scene
from fsi.command import Refusal, start

COLUMNS = ("scene", "effect", "time", "spread", "instructions", "memory", "messages", "bytes", "collectives")


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
    body = "set group all mol 1" if bodies == 1 else f"region low block INF INF INF {0.5 * m / n!r} INF INF\nset group all mol 1\nset region low mol 2"
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
    """The bundled deck, n particles per metre, without its output, its balancing and some of its effects, with others."""
    text = scene.deck("elastic_gate").read_text()
    cut = {"viscosity": r" artificial/visc 0.05 0", "diffusion": r" density/diffusion 0.1", "walls": r"^fix +walls .*$",
           "rubber viscosity": r"(?<=fsi/solid/tl) artificial/visc 0.1 0", "output": r"^(dump|fix +tip|compute +(disp|last|previous|front|fields)|print"
           r"|variable +(tip_x|tip_y|front|reflected)|run|fix +balance|thermo_style|thermo_modify|dump_modify|thermo) .*(\n[^\n]*title.*|\n +id type.*)?$"}
    # the time step of the start, with a number of sub-steps that does not change: one run's instructions are another's
    dx, n_sub = 1 / n, 1 if "substeps" in without else 8
    text = re.sub(r"^fix +dt .*$", f"timestep {0.375 * dx * n_sub / 153!r}", re.sub(r"^(fix +sph .*)$", rf"\1 substeps {n_sub}", text, flags=re.M), flags=re.M)
    for part in ("output", *(part for part in without if part != "substeps")):
        text, count = re.subn(cut[part], "", text, flags=re.M)
        if not count:
            raise Refusal(f"the gate's deck has no '{cut[part]}' any more")
    text = text.replace('"fsi/fluid sound', f'"fsi/fluid {water} sound').replace("fsi/solid/tl artificial", f"fsi/solid/tl {rubber} artificial")
    text = re.sub(r"^(variable +dx index) \S+", rf"\1 {1 / n!r}", text, flags=re.M)
    return text + f"{commands}\nthermo 1000000\n"


STEP = "fix dt all fsi/dt 10"
WATCH = "fix watch all fsi/watch 10 mach off distance off density off courant off energy off restart off dump off"
LEDGER = "compute ledger all fsi/energy\nthermo_style custom step c_ledger[1]"
SCENES = {  # scene: title, deck, {effect: settings with it, or (without, with)}
    "fluid": ("Water", fluid, {
        "artificial viscosity": {"style": "artificial/visc 0.05 0"},
        "laminar viscosity": {"style": "laminar/visc"},
        "laminar viscosity, central": {"style": "laminar/visc/central"},
        "density diffusion": {"style": "density/diffusion 0.1"},
        "shifting": {"style": "shift 0.1"},
        "shifting, every 4 steps": {"style": "shift 0.1 shift/every 4"},
        "mirror walls": {"walls": "yes"},
        "free-surface rule": {"style": "surface 0.9 bulk"},
        "free-surface rule, every 10 steps": {"style": "surface 0.9 bulk", "sph": "surface/every 10"},
        "density by summation": {"sph": "fluid summation"},
        "density by ratio": {"sph": "fluid ratio"},
        "tension, Tait, background": {"style": "eos tait tension yes background 1"},
        "adaptive time step": {"commands": STEP},
        "watch": {"commands": WATCH},
        "energy ledger": ({"style": "artificial/visc 0.05 0"}, {"style": "artificial/visc 0.05 0", "commands": LEDGER})}),
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
        "watch": {"commands": WATCH},
        "energy ledger": {"commands": LEDGER}}),
    "total": ("Solid, total Lagrangian", total, {
        "artificial viscosity": {"style": "artificial/visc 0.1 0"},
        "hourglass control": ({"style": "hourglass 0"}, {}),
        "neo-Hookean": {"style": "law neohookean"},
        "hypoelastic": {"style": "law hypo", "stress": ""},
        "plasticity (hypoelastic)": {"style": "law hypo", "stress": "plastic", "material": "metal"},
        "damage": {"style": "damage 0.5"},
        "adaptive time step": {"commands": STEP},
        "watch": {"commands": WATCH},
        "energy ledger": {"commands": LEDGER}}),
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
        "watch": {"commands": WATCH},
        "energy ledger": {"commands": LEDGER}})}
TIMED, COUNTED = {"gate": (1000, 0)}, {"gate": (400, 0)}  # n, m of the timed and of the counted runs; elsewhere:
SIZE, SMALL, STEPS = (160, 100), (40, 25), {"fluid": 60, "updated": 60, "total": 120, "gate": 60}


def cases(name):
    """[(effect, settings without, settings with)] of a scene."""
    return [(label, *(change if isinstance(change, tuple) else ({}, change))) for label, change in SCENES[name][2].items()]


def deck(name, settings, size):
    """The input of one case, without run."""
    text = SCENES[name][1](*size, **settings)
    return text if name == "gate" else write_materials(text)


def rows_of(name, kept, turns):
    """The table of a scene, and what is sent in a step of the first case without its effect."""
    small = [deck(name, s, COUNTED.get(name, SMALL)) for _, *both in cases(name) for s in both]
    say(f"cost: {SCENES[name][0]}: counting instructions of {len(small)} runs")
    counts = kept.get(["instructions", small], lambda: measure.instructions(small))
    still = [re.sub(r"^timestep .*", "timestep 1e-7", text, flags=re.M) for text in small]  # no list is rebuilt on the way
    sent = kept.get(["messages", still], lambda: measure.messages(still))
    rows = []
    for k, (label, without, with_it) in enumerate(cases(name)):
        found = kept.pair(*(deck(name, s, TIMED.get(name, SIZE)) + f"\nrun {STEPS[name]}" for s in (without, with_it)), turns)
        a, b = sent[2 * k], sent[2 * k + 1]
        row = {"scene": name, "effect": label, "time": found.ratio - 1, "spread": found.spread,
               "instructions": counts[2 * k + 1] / counts[2 * k] - 1, "memory": found.memory[1] - found.memory[0],
               "messages": b["messages"] - a["messages"], "bytes": (b["bytes"] - a["bytes"]) / a["ghosts"],
               "collectives": b["collectives"] - a["collectives"]}
        say("cost:   {effect}: time {time:+.1%} ± {spread:.1%}, instructions {instructions:+.1%}, {memory:+.0f} B a particle, "
            "{messages:+.2g} messages and {bytes:+.1f} B a ghost".format(**row))
        rows.append(row)
    a = sent[0]
    return rows, {"messages": a["messages"], "bytes": a["bytes"] / a["ghosts"], "collectives": a["collectives"]}


def draw(path, tables):
    """Added time and instructions of each effect, a panel for each scene."""
    with plot.picture(path, 8.6, 0.19 * sum(len(rows) + 3 for rows, _ in tables.values())) as figure:
        heights = [len(rows) + 1 for rows, _ in tables.values()]
        panels = figure.subplots(len(tables), 1, squeeze=False, sharex=True, gridspec_kw={"height_ratios": heights})[:, 0]
        for axes, (name, (rows, _)) in zip(panels, tables.items()):
            y = range(len(rows))
            axes.barh([k - 0.2 for k in y], [100 * r["time"] for r in rows], 0.4, color=plot.BLUE, label="CPU time",
                      xerr=[100 * r["spread"] for r in rows], error_kw={"elinewidth": 0.8, "ecolor": plot.GREY})
            axes.barh([k + 0.2 for k in y], [100 * r["instructions"] for r in rows], 0.4, color=plot.ORANGE, label="instructions")
            axes.set_yticks(list(y), [r["effect"] for r in rows])
            axes.invert_yaxis()
            axes.set_title(SCENES[name][0], loc="left")
            axes.axvline(0.0, color=plot.GREY, linewidth=0.8)
            axes.grid(axis="y", visible=False)
        panels[0].legend()
        panels[-1].set_xlabel("added per step [% of the same scene without]")
        figure.tight_layout()


def page(tables):
    """The page's text."""
    lines = ["# What each effect costs", "",
             "An effect that a deck does not name is not computed, stored or sent. This is what naming it adds to a step. Written by "
             "`tools/cost effects`; the numbers are in [effects.csv](effects.csv).", "",
             "![Added time and instructions of each effect](effects.png)", "",
             "* time: CPU time with over without, in one process in turns (A B B A A B); median, ± half the range",
             "* instructions: of the time loop by valgrind's callgrind, difference of two run lengths; the same in every repetition",
             "* memory: what LAMMPS reports, bytes per particle (arrays grow in steps, some per cent more than there are particles)",
             "* messages, bytes: what a rank of two sends in a step, beyond the scene without; bytes over its number of ghosts. Counted around the "
             "MPI calls; collective calls are mean numbers per step"]
    for name, (rows, base) in tables.items():
        lines += ["", f"## {SCENES[name][0]}", "",
                  f"Without: {base['messages']:.3g} messages, {base['bytes']:.0f} bytes a ghost and {base['collectives']:.2g} collective calls in a step.", "",
                  "| effect | time | instructions | memory [B/particle] | messages | bytes a ghost | collective calls |", "|---|---|---|---|---|---|---|"]
        for r in rows:
            lines.append(f"| {r['effect']} | {r['time']:+.1%} ± {r['spread']:.1%} | {r['instructions']:+.2%} | {r['memory']:+.0f} | "
                         f"{r['messages']:+.2g} | {r['bytes']:+.1f} | {r['collectives']:+.2g} |")
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost effects"""
    job = Job("effects", arguments, turns=3, words=SCENES)
    tables = {name: rows_of(name, job.kept, job.turns) for name in job.chosen or SCENES}
    rows = [row for table, _ in tables.values() for row in table]
    draw(job.target / "effects.png", tables)
    job.write(COLUMNS, rows, 5, page(tables), {"effects": rows, "bases": {n: b for n, (_, b) in tables.items()}})
    say(f"cost: page, picture and table are in {job.target}")
    return 0


if __name__ == "__main__":
    start("cost", main)
