"""What a rank has and sends as a scene grows with the ranks: a cell of it for each, of every kind
of scene. tools/cost ranks"""

import os
import tempfile
from pathlib import Path

import measure
import numpy as np
from tool import Job, say

from fsi import dump, plot
from fsi.command import start

EDGE = 12  # particles along the edge of a cell
CELL = """units si
dimension 3
boundary {boundary}
atom_style {atoms}
atom_modify map array
newton on
{processors}
lattice sc 0.01 origin 0.5 0.5 0.5
region box block {along} 0 0.12 0 0.12 units box
create_box 5 box
{create}
{replicate}
reset_atoms id sort yes
group water type 1 5
displace_atoms {moved} random 5e-4 5e-4 5e-4 1 units box
pair_style {pair}
fsi/material body solid rho 1100 young 5e4 poisson 0.3
fsi/material block wall rho 600
{coeff}
neighbor 0.003 bin
fix fsi {mover} fsi 0.01 {fsi}
variable u atom 0.2*sin(2*PI*y/0.12)
variable v atom 0.2*sin(2*PI*z/0.12)
variable w atom 0.2*sin(2*PI*x/0.12)
velocity water set v_u v_v v_w
timestep 1e-4
{more}
thermo 1000000
"""
WATER = "fsi/fluid preset closed 1"
ALONE = {"boundary": "p p p", "along": "0 0.12", "atoms": "fsi", "create": "create_atoms 1 box",
         "moved": "all", "pair": WATER, "mover": "all", "fsi": "",
         "coeff": "pair_coeff * * materials.fsi water water block water water", "more": ""}
# kind: what its cell has; along which axes cells are repeated
KINDS = {
    "water": (ALONE, "xyz"),
    "elastic plate through all cells": ({
        **ALONE, "pair": f"hybrid {WATER} fsi/solid/tl artificial/visc 0.1 0", "fsi": "substeps 2", "create": """region body block INF INF INF INF 0.03 0.07 units box
region water block INF INF INF INF 0.03 0.07 units box side out
create_atoms 2 region body
create_atoms 1 region water
set type 2 mol 1""", "coeff": """pair_coeff * * fsi/fluid materials.fsi water body block water water
pair_coeff * * fsi/solid/tl NULL NULL body NULL NULL NULL"""}, "xy"),
    "levels": ({**ALONE, "fsi": "spacing 5 $(0.01*2^(-1/3))", "more": """region near block INF INF INF INF 0.03 0.07 units box
fix refine water fsi/refine 6 types 1 5 region near"""}, "xy"),
    "open ends": ({**ALONE, "boundary": "f p p", "along": "-0.08 0.2",
                   "create": "region water block 0 0.12 INF INF INF INF units box\ncreate_atoms 1 "
                   "region water", "more": "fix in water fsi/inlet xlo 0 velocity 0.1 0 0\n"
                   "fix out water fsi/outlet xhi 0.12 pressure 0"}, "yz"),
    "floating blocks": ({**ALONE, "moved": "water", "mover": "water", "create": """region block block 0.03 0.07 0.03 0.07 0.03 0.07 units box
region water block 0.03 0.07 0.03 0.07 0.03 0.07 units box side out
create_atoms 3 region block
create_atoms 1 region water""", "more": """group block type 3
variable cell atom 1+floor(x/0.12)+1000*floor(y/0.12)+1000000*floor(z/0.12)
set group block mol v_cell
fix wall block fsi/wall/particle slip no
fix float block rigid/small molecule
comm_modify cutoff 0.04"""}, "xyz"),
    "grains": ({**ALONE, "atoms": "hybrid fsi sphere", "moved": "water", "mover": "water", "pair": f"hybrid/overlay {WATER} fsi/grain granular", "create": """create_atoms 1 box
lattice sc 0.03 origin 0.5 0.5 0.5
create_atoms 4 box
set type 4 diameter 0.008
set type 4 density 2500""", "coeff": """pair_coeff * * fsi/fluid materials.fsi water water water NULL water
pair_coeff 1 4 fsi/grain
pair_coeff 2*3 4 none
pair_coeff 4 5 none
pair_coeff 4 4 granular hooke 200 0.5 tangential linear_history 100 0.5 0.5 damping coeff_restitution
comm_modify vel yes"""}, "xyz")}
RANKS = (8, 27, 64)


def grid(ranks, axes):
    """Ranks along x, y, z: as near to each other as they can be along the axes that cells are
    repeated along."""
    edge = round(ranks ** (1 / 3))
    counts = {8: (4, 2), 27: (9, 3), 64: (8, 8)}[ranks] if len(axes) == 2 else (edge,) * 3
    along = dict(zip(axes, counts))
    return tuple(along.get(axis, 1) for axis in "xyz")


def deck(kind, cells, ranks=None):
    """The scene of so many cells, on as many ranks or on this number."""
    settings, axes = KINDS[kind]
    copies = " ".join(map(str, grid(cells, axes)))
    return measure.write_materials(CELL.format(**settings, replicate=f"replicate {copies}",
                                               processors=f"processors {copies}"
                                               if ranks in (None, cells) else ""))


STEPS = 24


def state(kind, cells, ranks):
    """Particles at the end of a short run, sorted so that those of two runs that are the same stand
    in the same places: columns x, v, rho."""
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        text = deck(kind, cells, ranks) + f"compute state all fsi/atom rho\nrun {STEPS}\n"
        text += ("write_dump all custom end.dump x y z vx vy vz c_state modify time yes format "
                 "float %.17g\n")
        measure.run(Path(name), text, ranks)
        frame = dump.read(Path(name) / "end.dump")[-1]
    found = np.column_stack([frame[column] for column in frame.columns])
    # by place, along no row: new IDs are given rank by rank
    return found[np.argsort(found[:, :3] @ np.sqrt([1.0, 0.3, 0.07]))]


def difference(kind, ranks):
    """Largest difference from one rank, relative to the scene's size, the largest velocity, the
    density."""
    one, many = state(kind, ranks, 1), state(kind, ranks, ranks)
    if one.shape != many.shape:
        return float("nan")
    size = np.repeat([np.abs(one[:, :3]).max(), np.abs(one[:, 3:6]).max(), 1e3], [3, 3, 1])
    return float((np.abs(one - many) / size).max())


def measured(kept, kind, ranks):
    """What the busiest rank has and sends in a step; how far the scene is from that of one rank."""
    sent, = kept.get(["ranks", deck(kind, ranks), ranks],
                     lambda: measure.messages([deck(kind, ranks)], ranks, max))
    return {**sent, "difference": kept.get(["ranks, one rank", deck(kind, ranks), STEPS],
                                           lambda: difference(kind, ranks))}


COLUMNS = ("scene", "ranks", "particles", "ghosts", "messages", "bytes", "collectives", "reduced",
           "memory", "difference")


def draw(path, rows):
    """Bytes that a rank sends in a step, by kind of scene and number of ranks."""
    with plot.picture(path, 7.2, 1.9) as figure:
        axes = figure.add_subplot()
        for k, (ranks, colour) in enumerate(zip(RANKS, (plot.BLUE, plot.ORANGE, plot.GREEN))):
            axes.bar([n + 0.25 * (k - 1) for n in range(len(KINDS))],
                     [r["bytes"] / 1e3 for r in rows if r["ranks"] == ranks], 0.22, color=colour,
                     label=f"{ranks} ranks")
        axes.set_xticks(range(len(KINDS)),
                        [kind.replace(" through", "\nthrough") for kind in KINDS], fontsize=8)
        axes.set(ylabel="kB of a rank and step")
        axes.grid(axis="x", visible=False)
        figure.legend(loc="upper center", ncol=3, fontsize=7.5, frameon=False)
        figure.tight_layout(rect=(0, 0, 1, 0.92))


def page(rows):
    """The page's text."""
    lines = ["# Many ranks", "",
             f"The scene grows with the ranks: each has a cell of {EDGE} particles along an edge "
             "(`tools/cost ranks`).",
             "The table is of the busiest rank. No step has new neighbor lists.",
             "*Reduced*: bytes of collective calls. *Difference*: the largest from one rank, "
             f"after {STEPS} steps.", "", "![Bytes that a rank sends](ranks.png)", "",
             "Each rank reduces 96 bytes of each floating body.",
             "An open end gathers what it makes at once, at the start its whole buffer.", "",
             "| cell | ranks | ghosts | messages | bytes | reduced | memory | difference |",
             "|---|---:|---:|---:|---:|---:|---:|---:|"]
    lines += [f"| {r['scene']} | {r['ranks']:.0f} | {r['ghosts']:,.0f} | {r['messages']:.1f} | "
              f"{r['bytes']:,.0f} | {r['reduced']:,.0f} | {r['memory'] / 2**20:.0f} MB "
              f"| {r['difference']:.0e} |" for r in rows]
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost ranks"""
    job = Job("ranks", arguments)
    os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")  # nothing is timed
    rows = []
    for kind in KINDS:
        for ranks in RANKS:
            rows.append({"scene": kind, "ranks": ranks, **measured(job.kept, kind, ranks)})
            say("cost: " + "; ".join(f"{rows[-1][name]:.4g} {name}" if name != "scene" else kind
                                     for name in COLUMNS))
    draw(job.folder / "ranks.png", rows)
    job.write(COLUMNS, rows, 6, page(rows))
    return 0


if __name__ == "__main__":
    start("cost", main)
