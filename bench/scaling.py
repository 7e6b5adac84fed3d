"""What a step costs that several ranks share: compute of a particle, bytes and exchanges of a
ghost, balance; and how large a scene may be. tools/cost scaling"""

import os
import re
import tempfile
from pathlib import Path

import effects
import measure
from tool import Job, say

from fsi import log, plot, scene
from fsi.command import start

DECK = Path(__file__).resolve().parent / "peers" / "in.water_fsi"
BORDER = 8 * 12 / 10  # bytes of a new ghost, every tenth step


def measured(kept):
    """Compute per particle and step, bytes of a ghost, exchanges of a step, for 3D water in its
    full physics."""
    text = DECK.read_text()
    size = {"dim": 3, "nx": 40, "ny": 40, "nz": 40, "kernel": "wendland", "hdx": 1.5}
    text = "".join(f"variable {n} index {v}\n" for n, v in size.items()) + text
    text = re.sub(r"^run .*", "", text, flags=re.M)

    def run():
        found = measure.simulate(text + "\nrun 10\nrun 10").finished[-1]
        # counted where no ghost is the rank's own and no list is built
        fixed = re.sub(r"^boundary .*", "boundary f f f",
                       re.sub(r"^neigh_modify .*", "", text, flags=re.M), flags=re.M)
        sent, = measure.messages([re.sub(r"^timestep .*", "timestep 1e-9", fixed, flags=re.M)])
        return {"tau": found.cpu_seconds / found.steps / found.atoms,
                "bytes": BORDER + sent["bytes"] / sent["ghosts"], "exchanges": sent["messages"],
                "w": 3.0 + 0.3, "neighbours": 2 * found.neighbours / found.atoms}
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
    """Mean of the largest over the mean number of particles of two ranks over a dam break, with and
    without fix balance."""
    # nothing is timed; on a busy machine a waiting rank only holds up the other
    os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
    found = {}
    for label, threshold in (("never", 1e3), ("fix balance", 1.05)):
        text = TANK.replace("THRESHOLD", f"{threshold:g}")

        def run(t=text):
            last = measure.simulate(t, 2).finished[-1]
            factor = last.thermo["v_fullest"]
            return {"mean": float(factor[1:].mean()), "largest": float(factor[1:].max())}
        found[label] = kept.get(["balance", text], run)
    return found


STILL = """
variable dx equal 1.0/N
units si
dimension 3
boundary f f f
atom_style fsi
region box block $(-4*v_dx) $(1+4*v_dx) $(-4*v_dx) $(1+4*v_dx) $(-4*v_dx) 1.5
create_box 1 box
lattice sc ${dx} origin 0.5 0.5 0.5
region water block 0 1 0 1 0 1 units box
create_atoms 1 region water
pair_style fsi/fluid sound 45 artificial/visc 0.05 0 density/diffusion 0.1
pair_coeff * * materials.fsi water_inviscid
fix sph all fsi ${dx} wendland 1.5
fix gravity all gravity 9.81 vector 0 0 -1
fix walls all fsi/wall/mirror xlo 0 xhi 1 ylo 0 yhi 1 zlo 0
fsi/set all hydrostatic 1
timestep $(0.1*v_dx/45)
neighbor $(0.3*v_dx) bin
run 0
run 3
variable start timer
write_restart still.restart
variable end timer
print "FSI write $(v_end-v_start)"
info memory out log
clear
variable start timer
read_restart still.restart
variable end timer
print "FSI read $(v_end-v_start)"
"""
SIZES = {"1 million": 100, "2 million": 126}  # particles of a cube of water along its edge
OTHERS = "LAMMPS' atoms and images at walls"


def seconds_of_files(said):
    """{write, read: seconds} that STILL says of its restart file."""
    return {what: float(re.search(rf"(?m)^FSI {what} (\S+)", said)[1])
            for what in ("write", "read")}


def size(kept):
    """Of still water in 3D, {size: bytes of a particle by what they are for, seconds}. The peak has
    what is there for a while, to write the restart file."""
    def run(text, n):
        with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
            folder = Path(name)
            setup = measure.seconds(folder, text[:text.index("run 3")])
            measure.run(folder, text)
            said, first = (folder / "log.lammps").read_text(), log.read(
                folder / "log.lammps").finished[0]
            lists = 4 * first.neighbours / n + 16  # entries, and a particle's length and place
            # and forces, which LAMMPS' are added to
            arrays, rows = int(re.search(r"all particles: (\d+) bytes", said)[1]) + 32, 32
            return {"neighbor lists": lists, "arrays of the package": arrays, "rows": rows,
                    OTHERS: first.bytes_per_rank / n - lists - arrays - rows / 2,
                    "peak": measure.peak(folder) / n, "setup": setup,
                    "restart file": (folder / "still.restart").stat().st_size / n,
                    **seconds_of_files(said)}
    found = {}
    for label, n in SIZES.items():
        text = STILL.replace("N", str(n), 1)
        found[label] = kept.get(["size", text], lambda t=text, m=n**3: run(t, m))
    return found


def cubes(m, particles, ranks):
    """A model: what a rank has in a step if each has a cube of water: seconds of compute, ghosts
    over particles, bytes. m: measured()."""
    edge = (particles / ranks) ** (1 / 3)
    ghosts = (edge + 2 * m["w"]) ** 3 - edge**3
    return m["tau"] * edge**3, ghosts / edge**3, m["bytes"] * ghosts


BODY = """
variable dx equal 1.0/N
units si
dimension 3
boundary f f f
atom_style fsi
region box block -0.1 1.1 -0.1 1.1 -0.1 1.1
create_box 1 box
lattice sc ${dx} origin 0.5 0.5 0.5
region body block 0 1 0 1 0 1 units box
create_atoms 1 region body
set group all mol 1
pair_style fsi/solid/tl artificial/visc 0.06 0
pair_coeff * * materials.fsi plate
fix sph all fsi ${dx} wendland 1.5
timestep $(0.1*v_dx/45)
neighbor $(0.3*v_dx) bin
run 0
info memory out log
"""
BODY_EDGE = 80  # particles along the edge of a cube


def body(kept):
    """Set-up of a total-Lagrangian body in 3D, half a million particles: CPU seconds from the start
    of the program, bytes of a particle at the peak."""
    text, n = BODY.replace("N", str(BODY_EDGE), 1), BODY_EDGE**3

    def run():
        with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
            return {"setup": measure.seconds(Path(name), text), "peak": measure.peak(Path(name))
                    / n}
    return kept.get(["body", text], run)


RANKS = (2, 4, 8, 16)


def still_deck(name, settings):
    """A bundled deck without output, balance during the run and choice of the step, so small a step
    that nothing moves."""
    if name == "elastic_gate":
        return re.sub(r"^timestep .*", "timestep 1e-7", effects.gate(settings["per_metre"], 0),
                      flags=re.M)
    text = re.sub(r"&\n", " ", scene.deck(name).read_text())
    text = re.sub(r"^(dump|dump_modify|run|thermo|thermo_style|print|fix "
                  r"+(dt|balance|series|history|gauges|peaks)|timestep) .*$", "", text, flags=re.M)
    return "".join(f"variable {n} index {v}\n"
                   for n, v in settings.items()) + text + "\ntimestep 1e-7\nthermo 1000000\n"


SHARED = {  # what several ranks share: deck, settings
    "elastic gate, 2.5 mm": ("elastic_gate", {"per_metre": 400}),
    "channel": ("cylinder_channel", {"Re": 100}),
    "3D dam break": ("dam_break_3d", {})}


def shared(kept):
    """What the busiest of several ranks has and sends in a step: {scene: {ranks: {...}}}."""
    os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
    found = {}
    texts = {label: still_deck(*of)
             for label, of in SHARED.items()} | {"3D water, 27,000 particles": still_water()}
    for label, text in texts.items():
        found[label] = {ranks: kept.get(["shared", text, ranks],
                                        lambda t=text, r=ranks: measure.messages([t], r, max)[0])
                        for ranks in RANKS}
    return found


def still_water():
    """STILL, small, without what times it."""
    text = STILL.replace("N", "30", 1)
    text = text[:text.index("run 0")]
    return re.sub(r"^timestep .*", "timestep 1e-7", text, flags=re.M)


def draw(path, rows):
    """Bytes of a particle by what they are for."""
    parts = [r for r in rows if r["what"].startswith("bytes of a particle, ")]
    sizes = list(SIZES)
    with plot.picture(path, 7.2, 1.7) as figure:
        axes = figure.add_subplot()
        for k, label in enumerate(sizes):
            left = 0.0
            for colour, r in zip((plot.BLUE, plot.ORANGE, plot.GREEN, plot.GREY, plot.RED),
                                 (r for r in parts if r["what"].endswith(label))):
                axes.barh(k, r["value"], 0.6, left=left, color=colour,
                          label=r["what"].split(", ")[1] if k == 0 else None)
                axes.text(left + 0.5 * r["value"], k, f"{r['value']:.0f}", ha="center", va="center",
                          color="white", fontsize=8)
                left += r["value"]
        axes.set_yticks(range(len(sizes)), sizes)
        axes.set(xlabel="bytes of a particle of 3D water")
        axes.grid(axis="y", visible=False)
        figure.legend(loc="upper center", ncol=5, fontsize=7.5, frameon=False)
        figure.tight_layout(rect=(0, 0, 1, 0.92))


def in_words(row):
    """value and unit"""
    value, unit = (1e6 * row["value"], "us") if row["unit"] == "s" and row["value"] < 1e-3 else (
        row["value"], row["unit"] or "")
    return f"{f'{value:.3g}' if value < 1e3 else f'{value:,.0f}'} {unit}".rstrip()


def side_by_side(rows):
    """[(what, rows)]: both sizes in one row, and what ranks send with their ghosts."""
    found = {}
    for row in rows:
        what, size, _ = row["what"].partition(" million")
        if size:
            what = f"{what.rpartition(', ')[0]}, 1 and 2 million"
        elif what in ("messages", "bytes sent") or what.startswith("the same, "):
            found[last].append(row)
            continue
        last = what.replace(": mean", ": mean, largest").replace(": ghosts over particles", "")
        found.setdefault(last, []).append(row)
    return list(found.items())


def page(rows, pairs, more=()):
    """The page's text; pairs: rows of tools/cost peers, of which those of two ranks; more: points
    of its list."""
    timed = [r for r in pairs if r["what"].startswith(("2 ranks", "2 threads"))
             and r["ratio"] is not None]
    threads = " and two threads (`-sf omp -pk omp 2`)" if any(r["what"].startswith("2 threads")
                                                              for r in timed) else ""
    lines = ["# Several ranks", "",
             "Forces are the same on any number of MPI ranks, to round-off.",
             f"Two ranks{threads} are timed (`tools/cost peers`). Of more, work and messages are "
             "counted (`tools/cost scaling`).", "",
             "![Bytes of a particle](scaling.png)", "",
             "- Bytes of a particle: still water in 3D, Wendland 1.5, skin 0.3 dx, five walls, one "
             "rank.",
             "- Temporary memory: the peak, at writing the restart file, minus the other rows.",
             "- Set-up: CPU time from the start to the first step. Restart files: wall-clock time.",
             "- 2 to 16 ranks, and a model of 10^4: [scaling.csv](scaling.csv).",
             "- Balance: a dam break in a half-empty tank, 1,250 particles, two ranks.",
             "- With the box cut in halves two ranks gain little: use `fix balance all balance 20 "
             "1.05 shift x 20 1.02`.",
             *more, "", "| quantity | value |", "|---|---:|"]
    lines += [f"| {r['what']} | {r['ratio']:.2f} ± {r['spread']:.2f} |" for r in timed]
    lines += [f"| {what} | {'; '.join(map(in_words, values))} |" for what, values in side_by_side(
        rows) if not re.search(r", \d+ ranks$|, model", what)]
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost scaling"""
    job = Job("scaling", arguments)
    m, balanced, sizes = measured(job.kept), balance(job.kept), size(job.kept)
    rows = [("compute of a particle and step, 3D water in its full physics", m["tau"], "s"),
            ("bytes of a ghost and step", m["bytes"], "B"),
            ("exchanges of a step", m["exchanges"], ""),
            ("support and skin over the spacing", m["w"], "")]
    for label, words in (("never", "box cut in halves"), ("fix balance", "fix balance")):
        rows += [(f"particles of the fuller of two ranks over the mean, {words}: mean",
                  balanced[label]["mean"], ""),
                 ("the same, largest", balanced[label]["largest"], "")]
    for label, of in sizes.items():
        known = ("neighbor lists", "arrays of the package", "rows", OTHERS)
        rows += [(f"bytes of a particle, {part}, {label}", of[part], "B") for part in known]
        rows += [(f"bytes of a particle, temporary, {label}",
                  of["peak"] - sum(of[part] for part in known), "B"),
                 (f"restart file, bytes of a particle, {label}", of["restart file"], "B")]
        rows += [(f"{word}, {label}", of[what], "s") for what, word in (
            ("setup", "set-up"), ("write", "write_restart"), ("read", "read_restart"))]
    seconds, ghosts, sent = cubes(m, 1e9, 1e4)
    rows += [("10^9 particles of 3D water on 10^4 ranks, model: compute", seconds, "s"),
             ("the same, ghosts over particles", ghosts, ""), ("the same, bytes", sent, "B")]
    solid = body(job.kept)
    rows += [(f"set-up of a total-Lagrangian body of {BODY_EDGE**3:,} particles in 3D",
              solid["setup"], "s"),
             ("bytes of a particle of this body, at the peak", solid["peak"], "B")]
    for label, of in shared(job.kept).items():
        for ranks, n in of.items():
            rows += [(f"{label}, {ranks} ranks: ghosts over particles",
                      n["ghosts"] / max(n["particles"], 1), ""), ("messages", n["messages"], ""),
                     ("bytes sent", n["bytes"], "B")]
    rows = [dict(zip(("what", "value", "unit"), row)) for row in rows]
    say("cost: " + "; ".join(f"{r['what']} {r['value']:.3g} {r['unit']}".rstrip() for r in rows))
    draw(job.folder / "scaling.png", rows)
    job.write(("what", "value", "unit"), rows, 4, page(rows, []))
    return 0


if __name__ == "__main__":
    start("cost", main)
