"""What a step of each variant of the solid costs beside the plain one: tools/cost solids [out=FOLDER] [turns=N]

A block that vibrates, 2D and 3D, one core. Each variant is timed next to the plain one in one process, in turns, and instructions of the
time loop are counted by callgrind, which does not depend on the machine's load. Writes solids.md, solids.csv and solids.png.
"""

import math
from dataclasses import replace

import measure
from tool import Job, say

from fsi import plot
from fsi.command import start

PLAIN = "updated Lagrangian, plain gradients"
UL, TL, HYPO = "fsi/solid", "fsi/solid/tl hourglass 0", "fsi/solid/tl hourglass 0 law hypo"
# variant: pair style with its keywords, keywords of fix fsi/stress (None: no such fix), two bodies
VARIANTS = {
    PLAIN: (UL, ""),
    "+ artificial viscosity": (f"{UL} artificial/visc 0.1 0", ""),
    "+ artificial stress": (f"{UL} artificial/stress 0.3", ""),
    "+ hourglass control": (f"{UL} hourglass 0.02", ""),
    "+ plasticity": (UL, "plastic"),
    "corrected gradients": (f"{UL} gradient corrected", ""),
    "corrected + artificial stress": (f"{UL} gradient corrected artificial/stress 0.3", ""),
    "corrected + hourglass control": (f"{UL} gradient corrected hourglass 0.5", ""),
    "quadratic gradients": (f"{UL} gradient quadratic", ""),
    "quadratic + artificial stress": (f"{UL} gradient quadratic artificial/stress 0.3", ""),
    "quadratic + hourglass control": (f"{UL} gradient quadratic hourglass 0.5", ""),
    "total Lagrangian, St. Venant-Kirchhoff": (TL, None),
    "TL, linear gradients": (f"{TL} gradient linear", None),
    "TL, neo-Hookean": (f"{TL} law neohookean", None),
    "TL + hourglass control": ("fsi/solid/tl", None),
    "TL + artificial viscosity": (f"{TL} artificial/visc 0.1 0", None),
    "TL + both": ("fsi/solid/tl artificial/visc 0.1 0", None),
    "TL + damage": (f"{TL} damage 0.5", None),
    "TL, hypoelastic": (HYPO, ""),
    "TL, hypoelastic + plasticity": (HYPO, "plastic"),
}
SIZE = {2: (60, 50), 3: (15, 14, 14)}  # particles
STEPS = {2: 60, 3: 12}


def deck(dim, style, stress):
    """The input of a variant, without its run."""
    dx, cells = 0.01, (*SIZE[dim], 1)[:3]
    lx, ly, lz = (dx * n for n in cells)
    depth = f"-0.1 {lz + 0.1}" if dim == 3 else f"{-dx / 2} {dx / 2}"
    return measure.write_materials(f"""units si
dimension {dim}
boundary f f {'f' if dim == 3 else 'p'}
atom_style fsi
newton on
region box block -0.1 {lx + 0.1} -0.1 {ly + 0.1} {depth}
create_box 1 box
lattice {'sc' if dim == 3 else 'sq'} {dx} origin 0.5 0.5 {0.5 if dim == 3 else 0}
region block block 0 {lx} 0 {ly} {f'0 {lz}' if dim == 3 else 'INF INF'} units box
create_atoms 1 region block
set group all mol 1
variable vx atom 0.3*sin(6.2832*x/{lx})*cos(6.2832*y/{ly})
variable vy atom -0.3*cos(6.2832*x/{lx})*sin(6.2832*y/{ly})
velocity all set v_vx v_vy NULL
pair_style {style}
pair_coeff * * materials.fsi block
fix sph all fsi {dx} wendland 1.5
{'' if stress is None else f'fix stress all fsi/stress {stress}'}
timestep 2e-5
neighbor {0.3 * dx} bin
neigh_modify every 1 delay 0 check yes
thermo 1000000
thermo_modify norm no
""")


def timed(dim, variant, turns):
    """A variant beside the plain one, as measure.Pair, after a run of each that does not count."""
    found = measure.pair(*(f"{deck(dim, *v)}run {STEPS[dim]}" for v in (VARIANTS[PLAIN], variant)), turns + 1)
    return replace(found, a=found.a[1:], b=found.b[1:])


def table(dim, turns):
    """Rows of one dimension."""
    counts = [n / math.prod(SIZE[dim]) for n in measure.instructions([deck(dim, *v) for v in VARIANTS.values()])]
    rows = []
    for (name, variant), count in zip(VARIANTS.items(), counts):
        pair = timed(dim, variant, turns)
        rows.append({"dimension": dim, "variant": name, "command": " ".join(filter(None, (variant[0], variant[1] and f"({variant[1]})"))),
                     "ns": 1e9 * min(pair.b), "ratio": pair.ratio, "spread": pair.spread, "instructions": count, "instruction_ratio": count / counts[0]})
        say(f"{dim}D  {name:40s} {rows[-1]['ns']:7.0f} ns  {pair.ratio:5.2f} +- {pair.spread:.2f}  {count:8.0f} instructions")
    return rows


def picture(path, tables):
    """Bars of time per particle-step, a panel per dimension."""
    with plot.picture(path, 8.2, 5.0) as figure:
        panels = figure.subplots(1, len(tables), sharey=True, squeeze=False)[0]
        for axes, (dim, rows) in zip(panels, tables.items()):
            place = range(len(rows))
            axes.barh(place, [row["ns"] for row in rows], 0.72, color=[plot.ORANGE if "TL" in row["variant"] or "total" in row["variant"]
                                                                       else plot.BLUE for row in rows])
            for k, row in enumerate(rows):
                axes.text(row["ns"], k, f" {row['ratio']:.2f}", va="center", fontsize=7)
            axes.set_yticks(list(place), [row["variant"] for row in rows], fontsize=8)
            axes.set(xlabel="ns per particle-step", xlim=(0, 1.15 * max(row["ns"] for row in rows)))
            axes.set_title(f"{dim}D", loc="left")
            axes.grid(False, axis="y")
        panels[0].invert_yaxis()
        figure.tight_layout()


def page(tables, turns):
    """The page as Markdown."""
    two, three = tables[2], tables[3]
    lines = ["# What each variant of the solid costs", "",
             f"Made by `tools/cost solids{f' turns={turns}' if turns != 5 else ''}`; all figures are in [solids.csv](solids.csv). Do not edit: it is written anew.", "",
             f"A vibrating block, {SIZE[2][0]} x {SIZE[2][1]} particles in 2D and {' x '.join(map(str, SIZE[3]))} in 3D, Wendland kernel with h = 1.5 dx, one core. "
             "Time: CPU nanoseconds per particle-step of the whole time loop, the least of all turns. Ratio: to the plain updated-Lagrangian solid, timed next to "
             "it in the same process, the median of the turns with half their range. Instructions: per particle-step, by callgrind.", "",
             "![Time per particle-step](solids.png)", "",
             "The number at a bar is its ratio to the first.", "",
             "| variant | 2D: ns | ratio | instructions | ratio | 3D: ns | ratio | instructions | ratio |", "|---|---|---|---|---|---|---|---|---|"]
    for a, b in zip(two, three):
        lines.append(f"| {a['variant']} | " + " | ".join(
            f"{r['ns']:.0f} | {r['ratio']:.2f} ± {r['spread']:.2f} | {r['instructions']:.0f} | {r['instruction_ratio']:.2f}" for r in (a, b)) + " |")
    lines += ["", "| variant | pair_style (fix fsi/stress) |", "|---|---|"] + [f"| {row['variant']} | `{row['command']}` |" for row in two]
    lines += ["", "A particle-step is not a step of the same length everywhere: total-Lagrangian solids beside a fluid take theirs as sub-steps, of which nothing "
              "but the bonds is computed, while the updated-Lagrangian solid holds the fluid to its own short step."]
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost solids"""
    job = Job("solids", arguments, turns=5)
    tables = {dim: table(dim, job.turns) for dim in (2, 3)}
    picture(job.target / "solids.png", tables)
    job.write(list(tables[2][0]), tables[2] + tables[3], 4, page(tables, job.turns))
    say(f"cost: {job.target / 'solids.md'}")
    return 0


if __name__ == "__main__":
    start("cost", main)
