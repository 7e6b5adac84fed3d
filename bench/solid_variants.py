#!/usr/bin/env python3
"""What a step of each variant of the solid costs beside the plain one: tools/cost solids [out=FOLDER] [turns=N]

A block that vibrates, 2D and 3D, one core. Each variant is timed next to the plain one in one process, in turns, and instructions of the
time loop are counted by callgrind, which does not depend on the machine's load. Writes solids.md, solids.csv and solids.png.
"""

import csv
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "python"))

from fsi import launch, log, paths, plot  # noqa: E402
from fsi.scene import Refusal, build  # noqa: E402

PLAIN = "updated Lagrangian, plain gradients"
UL, TL, HYPO = "fsi/solid", "fsi/solid/tl", "fsi/solid/tl law hypo"
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
    "TL + hourglass control": (f"{TL} hourglass 0.05", None),
    "TL + artificial viscosity": (f"{TL} artificial/visc 0.1 0", None),
    "TL + both": (f"{TL} hourglass 0.05 artificial/visc 0.1 0", None),
    "TL + damage": (f"{TL} damage 0.5", None),
    "TL, hypoelastic": (HYPO, ""),
    "TL, hypoelastic + plasticity": (HYPO, "plastic"),
}
SIZE = {2: (60, 50), 3: (15, 14, 14)}  # particles
STEPS = {2: 60, 3: 12}
SHORT, LONG = 2, 6  # steps of the two counted runs, whose difference is taken
MATERIAL = """# DATE: 2026-11-21 UNITS: si CITATION: none
block solid rho 1000 young 2e6 poisson 0.4 yield 2e3 hardening 1e5
"""


def deck(dim, style, stress):
    """The input of a variant, without its run."""
    dx, cells = 0.01, (*SIZE[dim], 1)[:3]
    lx, ly, lz = (dx * n for n in cells)
    depth = f"-0.1 {lz + 0.1}" if dim == 3 else f"{-dx / 2} {dx / 2}"
    return f"""units si
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
pair_coeff * * material.fsi block
fix sph all fsi {dx} wendland 1.5
{'' if stress is None else f'fix stress all fsi/stress {stress}'}
timestep 2e-5
neighbor {0.3 * dx} bin
neigh_modify every 1 delay 0 check yes
thermo 1000000
thermo_modify norm no
"""


def lammps(folder, text, *before):
    """Runs an input in `folder`; its log."""
    (folder / "material.fsi").write_text(MATERIAL)
    (folder / "in.deck").write_text(text)
    command = [*before, str(paths.BUILD / "lmp"), "-in", "in.deck", "-log", "log.lammps", "-screen", "none", "-nocite"]
    done = subprocess.run(command, cwd=folder, env=launch.environment(), stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    found = log.read(folder / "log.lammps")
    if done.returncode:
        raise Refusal("; ".join(found.errors or [done.stderr[-300:]]))
    return found


def times(dim, plain, variant, turns):
    """Nanoseconds of CPU per particle-step, [(plain, variant)]: in one process, ABBAAB..., after a run of each that does not count."""
    order = "AB" + "".join("AB" if k % 2 == 0 else "BA" for k in range(turns))
    texts = {"A": deck(dim, *plain), "B": deck(dim, *variant)}
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        runs = lammps(Path(name), "clear\n".join(f"{texts[which]}run {STEPS[dim]}\n" for which in order)).finished
    each = [1e9 * run.loop_seconds * run.cpu_use / run.steps / run.atoms for run in runs]
    of = {which: [t for t, o in zip(each, order) if o == which][1:] for which in "AB"}
    return list(zip(of["A"], of["B"]))


def instructions(dim, variants):
    """Instructions per particle-step of each variant, in one process."""
    loop = "LAMMPS_NS::Verlet::run(int)"
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        folder = Path(name)
        found = lammps(folder, "clear\n".join(f"{deck(dim, *v)}run {SHORT}\nrun {LONG}\n" for v in variants), "valgrind", "--tool=callgrind",
                       f"--toggle-collect={loop}", f"--dump-before={loop}", "--combine-dumps=no", "--callgrind-out-file=count")
        # a part is what was counted up to the next run; the last has no number
        parts = [*sorted(folder.glob("count.*"), key=lambda p: int(p.suffix[1:])), folder / "count"]
        counts = [sum(map(int, re.findall(r"^totals: (\d+)", p.read_text(), re.M))) for p in parts if p.exists()][-2 * len(variants):]
    return [(b - a) / (LONG - SHORT) / found.finished[0].atoms for a, b in zip(counts[::2], counts[1::2])]


def measure(dim, turns):
    """Rows of one dimension: {"variant", "ns", "ratio", "spread", "instructions"}."""
    counted = instructions(dim, VARIANTS.values()) if shutil.which("valgrind") else [float("nan")] * len(VARIANTS)
    rows = []
    for (name, variant), count in zip(VARIANTS.items(), counted):
        pairs = times(dim, VARIANTS[PLAIN], variant, turns)
        ratios = [b / a for a, b in pairs]
        rows.append({"dimension": dim, "variant": name, "command": " ".join(filter(None, (variant[0], variant[1] and f"({variant[1]})"))),
                     "ns": min(b for _, b in pairs), "ratio": statistics.median(ratios), "spread": (max(ratios) - min(ratios)) / 2,
                     "instructions": count, "instruction_ratio": count / counted[0]})
        print(f"{dim}D  {name:40s} {rows[-1]['ns']:7.0f} ns  {rows[-1]['ratio']:5.2f} +- {rows[-1]['spread']:.2f}  {count:8.0f} instructions", flush=True)
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
    given = dict(a.partition("=")[::2] for a in arguments)
    if set(given) - {"out", "turns"} or not given.get("turns", "5").isdecimal() or int(given.get("turns", "5")) < 1:
        raise Refusal("tools/cost solids takes out=FOLDER and turns=N, N at least 1")
    if not build():
        return 1
    turns, out = int(given.get("turns", "5")), Path(given.get("out", paths.ROOT / "doc" / "cost"))
    out.mkdir(parents=True, exist_ok=True)
    tables = {dim: measure(dim, turns) for dim in (2, 3)}
    with open(out / "solids.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(tables[2][0]), lineterminator="\n")
        writer.writeheader()
        for row in tables[2] + tables[3]:
            writer.writerow({key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()})
    picture(out / "solids.png", tables)
    (out / "solids.md").write_text(page(tables, turns), encoding="utf-8")
    print(f"cost: {out / 'solids.md'}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Refusal as refusal:
        sys.exit(f"cost: {refusal}")
