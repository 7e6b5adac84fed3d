"""What a step costs that several ranks share: compute of a particle, bytes and exchanges of a ghost, balance. tools/cost scaling"""

import os
import re
from pathlib import Path

import measure
from tool import Job, say

from fsi.command import start

DECK = Path(__file__).resolve().parent / "peers" / "in.water_fsi"
OWN = 8 * (6 + 3)  # bytes of LAMMPS' own for a ghost in a step: positions and velocities out, forces back
BORDER = 8 * 12 / 10  # bytes of a new ghost, every tenth step


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


def page(rows, pairs):
    """The page's text; pairs: rows of tools/cost peers, of which those of two ranks."""
    lines = ["# Several ranks", "",
             "The package runs on any number of MPI ranks, as LAMMPS does, and gives the same forces to round-off.",
             "Two ranks were timed. What more ranks give was not measured.", "",
             "- Bytes and exchanges are what *fix fsi* prints; `unittest/tools/test_pay.py` checks them around the MPI calls.",
             "- Balance: a dam break in a tank that is half empty, 1,250 particles, two ranks, 0.5 s.",
             "- With the box cut in halves one rank has nearly all particles, and two ranks gain little: use `fix balance all balance 20 1.05 shift x 20 1.02`.",
             "- Two ranks are timed by `tools/cost peers`, the rest by `tools/cost scaling`.", "", "| quantity | value |", "|---|---:|"]
    lines += [f"| {r['what']} | {r['ratio']:.2f} ± {r['spread']:.2f} |" for r in pairs if r["what"].startswith("2 ranks") and r["ratio"] is not None]
    for r in rows:
        value, unit = (1e6 * r["value"], "us") if r["unit"] == "s" else (r["value"], r["unit"] or "")
        lines.append(f"| {r['what']} | {value:.3g} {unit}".rstrip() + " |")
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost scaling"""
    job = Job("scaling", arguments)
    m, balanced = measured(job.kept), balance(job.kept)
    rows = [("compute of a particle and step, 3D water in its full physics", m["tau"], "s"), ("bytes of a ghost and step", m["bytes"], "B"),
            ("exchanges of a step", m["exchanges"], ""), ("support and skin over the spacing", m["w"], "")]
    for label, words in (("never", "box cut in halves"), ("fix balance", "fix balance")):
        rows += [(f"particles of the fuller of two ranks over the mean, {words}: mean", balanced[label]["mean"], ""), ("the same, largest", balanced[label]["largest"], "")]
    rows = [dict(zip(("what", "value", "unit"), row)) for row in rows]
    say("cost: " + "; ".join(f"{r['what']} {r['value']:.3g} {r['unit']}".rstrip() for r in rows))
    job.write(("what", "value", "unit"), rows, 4, page(rows, []))
    return 0


if __name__ == "__main__":
    start("cost", main)
