"""Many ranks, by a model: compute per particle and bytes per ghost are measured here, the network is assumed. tools/cost scaling

A step of the busiest of P ranks, each with a cube of n = N/P particles (a column in a slab for few ranks is no different to leading order):
    t = (1 + imbalance) n (tau + g G/n) + messages latency + G bytes/bandwidth + collectives latency log2 P
    G = (n^(1/3) + 2 w)^3 - n, the ghosts, w = (support + skin)/dx
"""

import math
import os
import re
from pathlib import Path

import measure
from tool import Job, say

from fsi import plot
from fsi.command import start

DECK = Path(__file__).resolve().parent / "peers" / "in.water_fsi"
OWN = 8 * (6 + 3)  # bytes of LAMMPS' own for a ghost in a step: positions and velocities out, forces back
BORDER = 8 * 12 / 10  # bytes of a new ghost, every tenth step
ASSUMED = {  # name in the page: value
    "latency": 2e-6,  # s, of a message, with the library's part
    "bandwidth": 25e9 / 64,  # bytes/s of a rank: a node's 200 Gbit/s shared by 64 ranks, all traffic leaving the node
    "ghost": 0.1,  # work on a ghost (gathering, pressure) over that on a particle
    "imbalance": 0.05, "collectives": 1}
RANKS = [1, 10, 100, 1000, 10000]
FIXED = [1e6, 1e7, 1e8, 1e9]  # particles of strong scaling
EACH = [1e4, 1e5]  # particles of a rank in weak scaling


def ghosts(n, w):
    """Ghosts of a rank with a cube of n particles."""
    return (n**(1 / 3) + 2 * w)**3 - n


def step(n_all, ranks, m, assumed=None):
    """Seconds of a step by the model. m: {"tau", "bytes", "exchanges", "w"}."""
    a = {**ASSUMED, **(assumed or {})}
    n = n_all / ranks
    if ranks == 1:
        return n * m["tau"]
    G = ghosts(n, m["w"])
    compute = (1 + a["imbalance"]) * (n + a["ghost"] * G) * m["tau"]
    swaps = 6 * max(1, math.ceil(m["w"] / n**(1 / 3)))  # a cube smaller than its ghosts' shell asks further neighbours
    network = m["exchanges"] * swaps * a["latency"] + G * m["bytes"] / a["bandwidth"]
    return compute + network + a["collectives"] * a["latency"] * math.log2(ranks)


def measured(kept):
    """Compute per particle and step, bytes of a ghost, exchanges of a step, for 3D water in its full physics."""
    text = DECK.read_text()
    size = {"dim": 3, "nx": 40, "ny": 40, "nz": 40, "kernel": "wendland", "hdx": 1.5}
    text = "".join(f"variable {n} index {v}\n" for n, v in size.items()) + text
    text = re.sub(r"^run .*", "", text, flags=re.M)

    def run():
        found = measure.simulate(text + "\nrun 10\nrun 10").finished[-1]
        banner = measure.announcements([text])[0]
        forward, back = map(int, re.search(r"positions and forces: (\d+) forward, (\d+) back", banner).groups())
        return {"tau": found.cpu_seconds / found.steps / found.atoms, "bytes": OWN + BORDER + int(re.search(r"(\d+) bytes of a fluid", banner)[1]),
                "exchanges": 2 + forward + back, "w": 3.0 + 0.3, "neighbours": 2 * found.neighbours / found.atoms}
    return kept.get(["measured", text], run)


TANK = """
variable dx equal 0.02
units si
dimension 2
boundary f f p
atom_style fsi
newton on
processors 2 1 1
region box block -0.05 2.05 -0.05 1.55 -0.01 0.01
create_box 1 box
lattice sq ${dx} origin 0.5 0.5 0
region water block 0 1 0 0.5 INF INF units box
create_atoms 1 region water
pair_style fsi/fluid sound 32 artificial/visc 0.05 0 density/diffusion 0.1
pair_coeff * * materials.fsi water_inviscid
fix sph all fsi ${dx} wendland 1.5
fix gravity all gravity 9.81 vector 0 -1 0
fix walls all fsi/wall/mirror xlo 0 xhi 2 ylo 0
fsi/set all hydrostatic 0.5
timestep 2.5e-4
neighbor $(0.3*v_dx) bin
neigh_modify every 1 delay 0 check yes
fix balance all balance 20 THRESHOLD shift x 20 1.02
compute proc all property/atom proc
variable first atom c_proc==0
compute first all reduce sum v_first
variable fullest equal 2*abs(c_first/count(all)-0.5)+1
thermo_style custom step v_fullest
thermo 20
run 2000
"""


def balance(kept):
    """Mean of the largest over the mean number of particles of two ranks over a dam break, with and without fix balance."""
    os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")  # nothing is timed; on a busy machine a waiting rank only holds up the other
    found = {}
    for label, threshold in (("never", 1e3), ("fix balance", 1.05)):
        text = TANK.replace("THRESHOLD", f"{threshold:g}")

        def run(t=text):
            last = measure.simulate(t, 2).finished[-1]
            factor = last.thermo["v_fullest"]
            return {"mean": float(factor[1:].mean()), "largest": float(factor[1:].max())}
        found[label] = kept.get(["balance", text], run)
    return found


def draw(path, m):
    with plot.picture(path, 8.2, 3.6) as figure:
        strong, weak = figure.subplots(1, 2)
        many = [10**(k / 4) for k in range(17)]
        for n, colour in zip(FIXED, (plot.GREY, plot.GREEN, plot.ORANGE, plot.BLUE)):
            ranks = [p for p in many if n / p >= 10]
            strong.loglog(ranks, [step(n, 1, m) / step(n, p, m) if p > 1 else 1.0 for p in ranks], color=colour, label=f"$10^{{{math.log10(n):.0f}}}$ particles")
        strong.loglog(many, many, color="black", linewidth=0.7, linestyle=":", label="ideal")
        strong.set(xlabel="ranks", ylabel="speed over one rank", title="Strong scaling")
        for n, colour in zip(EACH, (plot.ORANGE, plot.BLUE)):
            weak.semilogx(many, [step(n, 1, m) / step(n * p, p, m) if p > 1 else 1.0 for p in many], color=colour, label=f"$10^{{{math.log10(n):.0f}}}$ particles a rank")
        weak.set(xlabel="ranks", ylabel="efficiency", title="Weak scaling", ylim=(0, 1.05))
        strong.legend()
        weak.legend()
        figure.tight_layout()


def rows_of(m):
    rows = []
    for n in FIXED:
        for p in RANKS:
            if n / p >= 100:
                t = step(n, p, m)
                rows.append({"kind": "strong", "particles": n, "ranks": p, "step": t, "efficiency": step(n, 1, m) / t / p})
    for n in EACH:
        for p in RANKS:
            t = step(n * p, p, m)
            rows.append({"kind": "weak", "particles": n * p, "ranks": p, "step": t, "efficiency": step(n, 1, m) / t})
    return rows


def page(m, rows, balanced):
    a = ASSUMED
    n = 1e5
    G = ghosts(n, m["w"])
    lines = [
        "# Scaling: a model", "",
        "Written by `tools/cost scaling`. No machine of many nodes was at hand: what one particle costs is measured, what crosses ranks is counted "
        "(fix fsi prints it, `unittest/tools/test_pay.py` checks it around the MPI calls), the network is assumed.", "",
        "![Strong and weak scaling](scaling.png)", "",
        "A step of the busiest of P ranks, each a cube of n = N/P particles:", "", "```text",
        "t = (1 + imbalance) (n + g G) tau + exchanges swaps latency + G bytes/bandwidth + latency log2 P",
        "G = (n^(1/3) + 2 w)^3 - n     ghosts, w = (support + skin)/dx", "```", "",
        "| quantity | value | from |", "|---|---|---|",
        f"| tau, compute per particle and step | {m['tau'] * 1e6:.2f} us | measured: 3D water, artificial viscosity, density diffusion, walls, Wendland 1.5, "
        f"{m['neighbours']:.0f} neighbours with the skin, lists rebuilt every 10 steps, one core |",
        f"| bytes of a ghost and step | {m['bytes']:.0f} | LAMMPS' own {OWN}, the package's {m['bytes'] - OWN - BORDER:.0f} (start-up list), new ghosts {BORDER:.0f} |",
        f"| exchanges in a step | {m['exchanges']} | LAMMPS' own 2, the package's {m['exchanges'] - 2} |",
        f"| w | {m['w']:.1f} | kernel and skin |",
        "| swaps of an exchange | 6 | LAMMPS' bricks; more where a cube is smaller than w |",
        f"| latency | {a['latency'] * 1e6:g} us | assumed |",
        f"| bandwidth of a rank | {a['bandwidth'] / 1e9:.2f} GB/s | assumed: 200 Gbit/s for a node of 64 ranks, all of it between nodes |",
        f"| g, work on a ghost over that on a particle | {a['ghost']:g} | assumed (gathering, pressure) |",
        f"| imbalance | {a['imbalance']:g} | assumed; see below |", "",
        "Nothing overlaps. Not in the model: cores of a node that share their memory's bandwidth (tau is one core's), input and output, "
        "the change of lists when particles move to another rank.", "",
        f"With 10^5 particles a rank there are {G:.0f} ghosts, and a step takes {step(n * 1e4, 1e4, m) * 1e3:.0f} ms, of which "
        f"{(m['exchanges'] * 6 + math.log2(1e4)) * a['latency'] * 1e3:.2f} ms are latency and {G * m['bytes'] / a['bandwidth'] * 1e3:.1f} ms transfer.", "",
        "| scaling | particles | ranks | step [ms] | efficiency |", "|---|---|---|---|---|"]
    lines += [f"| {r['kind']} | 10^{math.log10(r['particles']):.0f} | {r['ranks']} | {r['step'] * 1e3:.3g} | {r['efficiency']:.0%} |"
              for r in rows if r["ranks"] > 1]
    worst, best = balanced["never"], balanced["fix balance"]
    lines += ["", "## Load balance", "",
              "A dam break in a tank that is half empty, 1250 particles, two ranks side by side, 0.5 s: the fuller rank's particles over the mean.", "",
              "| | mean | largest | speed of two ranks over one, at most |", "|---|---|---|---|",
              f"| equal halves of the box | {worst['mean']:.2f} | {worst['largest']:.2f} | {2 / worst['mean']:.2f} |",
              f"| `fix balance all balance 20 1.05 shift x 20 1.02` | {best['mean']:.3f} | {best['largest']:.2f} | {2 / best['mean']:.2f} |"]
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost scaling"""
    job = Job("scaling", arguments)
    m = measured(job.kept)
    say("cost: {0:.3g} us a particle and step, {1:.0f} bytes a ghost, {2} exchanges".format(m["tau"] * 1e6, m["bytes"], m["exchanges"]))
    balanced = balance(job.kept)
    rows = rows_of(m)
    draw(job.target / "scaling.png", m)
    job.write(list(rows[0]), rows, 4, page(m, rows, balanced), {"measured": m, "assumed": ASSUMED, "balance": balanced, "rows": rows})
    say(f"cost: page, picture and table are in {job.target}")
    return 0


if __name__ == "__main__":
    start("cost", main)
