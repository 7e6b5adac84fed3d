"""What a step of each variant of the solid costs next to the plain one: tools/cost solids
[out=FOLDER] [turns=N]

A block that vibrates, 2D and 3D, one core. Each variant is timed next to the plain one in one
process, in turns, and instructions of the time loop are counted by callgrind, which does not depend
on the machine's load. Its table is a part of the page of tools/cost effects.
"""

import math
from dataclasses import replace

import measure
from tool import Job, say

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
SAME = {  # scene and effect of tools/cost effects: the variant, and over which
    ("updated", "artificial viscosity"): ("+ artificial viscosity", PLAIN),
        ("updated", "artificial stress"): ("+ artificial stress", PLAIN),
    ("updated", "corrected gradients"): ("corrected gradients", PLAIN),
        ("updated", "quadratic gradients"): ("quadratic gradients", PLAIN),
    ("updated", "plasticity"): ("+ plasticity", PLAIN),
    ("total", "artificial viscosity"): ("TL + both", "TL + hourglass control"),
    ("total", "hourglass control"): ("TL + hourglass control",
                                     "total Lagrangian, St. Venant-Kirchhoff"),
    ("total", "neo-Hookean"): ("TL, neo-Hookean", "total Lagrangian, St. Venant-Kirchhoff"),
    ("total", "damage"): ("TL + damage", "total Lagrangian, St. Venant-Kirchhoff"),
    ("total", "hypoelastic"): ("TL, hypoelastic", "total Lagrangian, St. Venant-Kirchhoff"),
    ("total", "plasticity (hypoelastic)"): ("TL, hypoelastic + plasticity",
                                            "total Lagrangian, St. Venant-Kirchhoff")}
FORMS = {  # comparisons of forms: the variant, and over which
    "total instead of updated Lagrangian": ("total Lagrangian, St. Venant-Kirchhoff", PLAIN),
    "the same with hourglass control, the default": ("TL + hourglass control", PLAIN),
    "updated Lagrangian as stiff as that: quadratic gradients, hourglass control": (
        "quadratic + hourglass control", PLAIN)}
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
    found = measure.pair(*(f"{deck(dim, *v)}run {STEPS[dim]}" for v in (VARIANTS[PLAIN], variant)),
                         turns + 1)
    return replace(found, a=found.a[1:], b=found.b[1:])


def table(dim, turns):
    """Rows of one dimension."""
    counts = [n / math.prod(SIZE[dim])
              for n in measure.instructions([deck(dim, *v) for v in VARIANTS.values()])]
    rows = []
    for (name, variant), count in zip(VARIANTS.items(), counts):
        pair = timed(dim, variant, turns)
        rows.append({"dimension": dim, "variant": name, "command":
                         " ".join(filter(None, (variant[0], variant[1] and f"({variant[1]})"))),
                     "ns": 1e9 * min(pair.b), "ratio": pair.ratio, "spread": pair.spread,
                     "instructions": count, "instruction_ratio": count / counts[0]})
        say(f"{dim}D  {name:40s} {rows[-1]['ns']:7.0f} ns  {pair.ratio:5.2f} +- {pair.spread:.2f}  "
            f"{count:8.0f} instructions")
    return rows


def ratio(rows, dim, variant, over):
    """Instructions of a variant over those of another."""
    counts = {row["variant"]: row["instructions"] for row in rows if row["dimension"] == dim}
    return counts[variant] / counts[over]


def added(rows, dim, scene, effect):
    """Share of instructions that the same effect adds to this block; None where there is no such
    variant, or no rows."""
    pair = SAME.get((scene, effect))
    return ratio(rows, dim, *pair) - 1.0 if pair and rows else None


def page(rows):
    """The table for a look; the manual has it on the page of effects."""
    lines = ["# Variants of the solid", "",
             "| dimension | variant | command | ns | over the plain one | instructions |",
             "|---|---|---|---|---|---|"]
    lines += [f"| {r['dimension']} | {r['variant']} | `{r['command']}` | {r['ns']:.0f} | "
              f"{r['ratio']:.2f} ± {r['spread']:.2f} | {r['instructions']:.0f} |" for r in rows]
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost solids"""
    job = Job("solids", arguments, turns=5)
    rows = [row for dim in (2, 3) for row in table(dim, job.turns)]
    job.write(list(rows[0]), rows, 4, page(rows))
    return 0


if __name__ == "__main__":
    start("cost", main)
