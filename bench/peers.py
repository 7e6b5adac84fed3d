"""The package and LAMMPS' own particle methods, in one program and one run: tools/cost peers"""

import random
import re
import statistics
import subprocess
from pathlib import Path

import measure
from tool import Job, say

from fsi import paths, plot, scene
from fsi.command import start

DECKS = Path(__file__).resolve().parent / "peers"
BUILD = paths.ROOT / "build-peers"
LMP = BUILD / "lmp"
PACKAGES = ("SPH", "BPM", "RHEO", "MACHDYN")  # RHEO needs BPM
SETTINGS = ("dim", "nx", "ny", "nz", "shake", "steps", "support", "kernel", "hdx", "form",
            "correction")
WATER2D = {"nx": 400, "ny": 250}
WATER3D = {"dim": 3, "nx": 50, "ny": 50, "nz": 50}
MIXED = {"shake": 0.2}  # of a spacing; particles and their IDs are in random order, too
FULL = "artificial viscosity, density diffusion, mirror walls"

# name: what is compared, settings of both, deck and further settings of ours, of the peer's. Steps
# are multiples of those between neighbour lists, so that the list that fix fsi builds at the start
# of a run weighs no more than one of the peer's
SPEEDS = {
    "sph 2d": ("sph/taitwater, 2D dam break, 100k particles, support 2.6 dx",
               {**WATER2D, "steps": 200},
               ("water_fsi", {"kernel": "wendland"}), ("water_sph", {})),
    "sph 3d": ("sph/taitwater, 3D dam break, 125k particles, support 2.6 dx",
               {**WATER3D, "steps": 60},
               ("water_fsi", {"kernel": "wendland"}), ("water_sph", {})),
    "sph 2d mixed": ("the same water in 2D, mixed", {**WATER2D, **MIXED, "steps": 200},
                     ("water_fsi", {"kernel": "wendland"}), ("water_sph", {})),
    "sph 3d mixed": ("the same water in 3D, mixed", {**WATER3D, **MIXED, "steps": 60},
                     ("water_fsi", {"kernel": "wendland"}), ("water_sph", {})),
    "rheo 2d": ("RHEO, 2D dam break, 20k particles, quintic, support 3 dx",
                {"nx": 160, "ny": 125, "steps": 120},
                ("water_fsi", {"kernel": "quintic", "hdx": 1.0}), ("water_rheo", {})),
    "rheo 3d": ("RHEO, 3D dam break, 14k particles, quintic, support 3 dx",
                {"dim": 3, "nx": 24, "ny": 24, "nz": 24, "steps": 60},
                ("water_fsi", {"kernel": "quintic", "hdx": 1.0}), ("water_rheo", {})),
    "tlsph": ("MACHDYN smd/tlsph, plate, 20k particles, support 3 dx, viscosity and hourglass "
              "control", {"steps": 300},
              ("plate_fsi", {"form": "tl"}), ("plate_tlsph", {})),
    "ulsph": ("MACHDYN smd/ulsph, plate, 20k particles, support 3 dx, plain gradients",
              {"steps": 300},
              ("plate_fsi", {"form": "ul"}), ("plate_ulsph", {})),
    "ulsph corrected": ("the same, corrected gradients and hourglass control", {"steps": 300},
                        ("plate_fsi", {"form": "corrected"}),
                        ("plate_ulsph", {"correction": "GRADIENT_CORRECTION"}))}
COLUMNS = ("what", "ours", "peer", "ratio", "spread", "neighbours_ours", "neighbours_peer")


def build():
    """LAMMPS with the package and its own particle methods, with the flags of the package's build;
    only what can be built."""
    cache = (paths.BUILD / "CMakeCache.txt").read_text()
    taken = [f"-D{line}" for line in cache.splitlines()
             if line.startswith(("LAMMPS_SOURCE_DIR:", "FSI_NATIVE:", "CMAKE_BUILD_TYPE:"))]
    eigen = any(Path(p, "eigen3/Eigen/Core").exists()
                for p in ("/usr/include", "/usr/local/include"))
    if not eigen:
        say("cost: MACHDYN is left out: it needs Eigen (Debian: libeigen3-dev)")
    packages = [p for p in PACKAGES if eigen or p != "MACHDYN"]
    configure = ["cmake", "-S", str(paths.ROOT), "-B", str(BUILD), "-G", "Ninja", *taken,
                 *(f"-DPKG_{p}=ON" for p in packages),
                 # RHEO calls LAPACK, which LAMMPS' cmake forgets
                 "-DDOWNLOAD_EIGEN3=OFF", "-DCMAKE_CXX_STANDARD_LIBRARIES=-llapack -lblas"]
    say(f"cost: bringing {BUILD.name} up to date ({', '.join(packages)}; minutes the first time)")
    BUILD.mkdir(exist_ok=True)
    with (BUILD / "peers.log").open("w") as output:
        for command in (configure, ["cmake", "--build", str(BUILD), "--target", "lmp", "-j"]):
            if subprocess.run(command, stdout=output, stderr=subprocess.STDOUT,
                              check=False).returncode:
                raise measure.Failed(f"the build of LAMMPS' own styles failed: {output.name}")
    return packages


def deck(name, settings):
    """A deck of bench/peers with settings, whatever ran before it in the same process."""
    text = (DECKS / f"in.{name}").read_text()
    forget = "".join(f"variable {n} delete\n" for n in SETTINGS)
    return forget + "".join(f"variable {n} index {v}\n" for n, v in settings.items()) + text


def mixed(text, data):
    """The deck with its particles from a file, made here, in which they and their IDs are in random
    order."""
    start, rest = text.split("\npair_style", 1)
    lines = start.splitlines()
    if not data.exists():
        plain = data.with_suffix(".plain")
        measure.simulate(f"{start}\nwrite_data {plain} nocoeff", binary=LMP)
        head, atoms = re.split(r"(?<=\n)(?=Atoms)", plain.read_text())
        title, _, *atoms = atoms.split("\n\nVelocities")[0].splitlines()
        order = random.Random(1)
        order.shuffle(atoms)
        names = [a.split()[0] for a in atoms]
        order.shuffle(names)
        data.write_text(f"{head}{title}\n\n"
                        + "".join(f"{n} {a.split(maxsplit=1)[1]}\n" for n, a in zip(names, atoms)))
        plain.unlink()
    before = next(k for k, line in enumerate(lines) if line.startswith("region"))
    return "\n".join([*lines[:before], f"read_data {data}",
                      *(line for line in lines if line.startswith("group")), "",
                      f"pair_style{rest}"])


def speeds(kept, packages, turns):
    rows = []
    for key, (what, both, *sides) in SPEEDS.items():
        if key.startswith(("tlsph", "ulsph")) and "MACHDYN" not in packages:
            continue
        texts = [deck(name, {**both, **own}) for name, own in sides]
        if "shake" in both:
            texts = [mixed(text, kept.folder / f"{key.replace(' ', '_')}_{name}.data")
                     for text, (name, _) in zip(texts, sides)]
        found = kept.pair(*texts, turns, LMP)
        rows.append({"what": what, "ours": 1 / statistics.median(found.a),
                     "peer": 1 / statistics.median(found.b), "ratio": found.ratio,
                     "spread": found.spread, "neighbours_ours": found.neighbours[0],
                     "neighbours_peer": found.neighbours[1]})
        say("cost:   {what}: {ours:.3g} against {peer:.3g} particle-steps a CPU second, ratio "
            "{ratio:.2f} ± {spread:.2f}".format(**rows[-1]))
    return rows


def bundled(name, **settings):
    """The deck of a scene with settings."""
    return "".join(f"variable {n} index {v}\n" for n, v in settings.items()) + scene.deck(
        name).read_text()


def in_turns(kept, runs, turns):
    """Some (text, ranks), each in a process of its own, in turns: of each its [seconds by the
    clock], [CPU seconds of a particle-step], [use of a core]."""
    def run():
        found = [([], [], []) for _ in runs]
        for k in range(turns):
            for one, (text, n) in list(zip(found, runs))[::1 if k % 2 == 0 else -1]:
                last = measure.simulate(text, n, LMP).finished[-1]
                for to, value in zip(one, (last.loop_seconds, last.cpu_seconds / last.steps
                                           / last.atoms, last.cpu_use)):
                    to.append(value)
        return found
    return kept.get(["in turns", runs, turns], run)


def channel(kept, turns):
    """What a flow around a cylinder pays beyond the water of the first row: wall particles, no
    slip, laminar viscosity, shifting, quintic kernel, output."""
    runs = [(bundled("cylinder_channel", across=20, Re=100, tend=0.1), 1),
            (deck("water_fsi", {**WATER2D, "kernel": "wendland", "steps": 100}), 1)]
    (_, ours, _), (_, water, _) = in_turns(kept, runs, turns)
    pair = measure.Pair(ours, water)
    say(f"cost:   channel: {pair.ratio:.2f} ± {pair.spread:.2f} of the water's speed")
    return {"what": "the package's own 2D water: flow past a cylinder, Re = 100, 20 particles to a "
            "diameter, with its output, 21k particles", "ours": 1 / statistics.median(ours),
            "peer": 1 / statistics.median(water), "ratio": pair.ratio, "spread": pair.spread}


def ranks(kept, what, text, turns):
    """Two ranks and two threads over one, and these threads over these ranks, by the clock; only
    where nothing else runs."""
    one, two, threads = in_turns(kept,
                                 [(text, 1), (text, 2), (f"package omp 2\nsuffix omp\n{text}", 1)],
                                 turns)
    busy = min(one[2] + two[2])  # threads wait for each other
    quiet = busy > 0.95
    rows = []
    for label, fast, slow in (("2 ranks over 1", two, one), ("2 threads over 1", threads, one),
                              ("2 threads over 2 ranks", threads, two)):
        pair = measure.Pair(fast[0], slow[0])
        say(f"cost:   {label}, {what}: {pair.ratio:.2f}"
            + ("" if quiet else f"; the machine was busy, {busy:.0%} of a core: no measurement"))
        rows.append({"what": f"{label}, {what}, by the clock", "ratio": pair.ratio if quiet
                     else None, "spread": pair.spread if quiet else None})
    return rows


def memory(kept):
    """Bytes a fluid particle beyond what LAMMPS holds for the same particles and neighbour list."""
    ours = deck("water_fsi", {**WATER2D, "steps": 10})
    lines = [line for line in ours.splitlines()
             if not line.startswith(("fix  ", "pair_", "balance"))]
    at = next(k for k, line in enumerate(lines) if line.startswith("timestep"))
    lines[at:at] = ["mass * 1", "pair_style zero $(v_hdx*2*v_dx)", "pair_coeff * *",
                    "fix move all nve"]
    own = "\n".join(lines).replace("atom_style      fsi", "atom_style      atomic")
    bytes_of = lambda text: measure.simulate(text, binary=LMP).finished[-1].bytes_per_rank / (
        WATER2D["nx"] * WATER2D["ny"])
    found = kept.get(["memory", ours, own], lambda: {"ours": bytes_of(ours), "own": bytes_of(own)})
    more = found["ours"] - found["own"]
    say(f"cost:   memory: {more:.0f} bytes a particle beyond LAMMPS' own {found['own']:.0f}")
    return {"what": "memory, 2D fluid, beyond atom_style atomic with the same neighbour list "
            "[bytes/particle]", "ours": found["ours"],
            "peer": found["own"], "ratio": more}


def compared(rows):
    """Those rows that have a peer of LAMMPS'."""
    return [r for r in rows if r.get("neighbours_peer") is not None]


def draw(path, rows):
    """Ratios of speeds, to be read at 800 pixels."""
    rows = compared(rows)
    with plot.picture(path, 7.6, 0.36 * len(rows) + 0.7) as figure:
        axes = figure.add_subplot()
        axes.barh(range(len(rows)), [r["ratio"] for r in rows], 0.65, color=plot.BLUE,
                  xerr=[r["spread"] for r in rows], error_kw={"ecolor": plot.GREY})
        for k, r in enumerate(rows):
            axes.text(r["ratio"] + (r["spread"] or 0.0), k, f" {r['ratio']:.1f}", va="center",
                      fontsize=10)
        axes.set_yticks(range(len(rows)), [_short(r["what"]) for r in rows], fontsize=10)
        axes.axvline(1.0, color="black", linewidth=0.8)
        axes.set(ylim=(len(rows) - 0.4, -0.6), xlim=(0, 1.12 * max(r["ratio"] for r in rows)))
        axes.set_xlabel("particle-steps in a second of this package over LAMMPS' style",
                        fontsize=10, x=0.3)
        axes.grid(axis="y", visible=False)
        figure.tight_layout()


def _short(what):
    """Style and scene, without the numbers that the table has."""
    style, *more = [part for part in what.split(", ")
                    if not re.search(r"particles|support|quintic", part)]
    return ", ".join([style.replace("MACHDYN smd",
                                    "MACHDYN, smd").replace("the same water", "SPH, mixed water"),
                      *(part for part in more if part != "mixed")]).replace("sph/taitwater", "SPH")


def page(rows):
    """The page's text."""
    lines = ["# Compared with LAMMPS' own styles", "",
             "Speed of the package and of LAMMPS' packages SPH, RHEO and MACHDYN, in one program "
             "with the same flags.", "",
             "![Ratio of speeds](peers.png)", "",
             "- Speed: particle-steps in a CPU second of the time loop on one core, wall particles "
             "included.",
             "- Both run in turns in one process. Kernel supports, skins and numbers of neighbor "
             "lists are equal. Input scripts: `bench/peers`.",
             f"- The package's water has {FULL}.",
             "- The total-Lagrangian plate has quadratic gradients, that of MACHDYN linear ones.",
             "- *sph/taitwater* has artificial viscosity and walls of particles, RHEO artificial "
             "viscosity and density damping.",
             "- Neighbors: entries of the list for each particle. 0: a total-Lagrangian solid "
             "needs no list here.",
             "- `tools/cost peers` measures this on your machine.", "",
             "| against | ours [10^6/s] | theirs [10^6/s] | ratio | neighbors, ours and theirs |",
             "|---|---:|---:|---:|---:|"]
    for r in compared(rows):
        lines.append(f"| {r['what']} | {r['ours'] / 1e6:.2f} | {r['peer'] / 1e6:.2f} | "
                     f"{r['ratio']:.3g} ± {r['spread']:.2g} | "
                     f"{r['neighbours_ours']:.1f}, {r['neighbours_peer']:.1f} |")
    more = next((r for r in rows if r["what"].startswith("memory")), None)
    own = next((r for r in rows if "flow past a cylinder" in r["what"]), None)
    if more and own:
        lines += ["", f"A particle of water takes {more['ratio']:.0f} bytes more than one of "
                  "*atom_style atomic* with the same neighbor list.",
                  "Flow past a cylinder, with no slip, walls of particles, viscosity and "
                  f"shifting, has {own['ratio']:.2f} of the speed of plain water."]
    return "\n".join(lines) + "\n"


def main(arguments):
    """tools/cost peers"""
    job = Job("peers", arguments, turns=3)
    packages = build()
    rows = speeds(job.kept, packages, job.turns) + [
        channel(job.kept, job.turns),
        *ranks(job.kept, "100k particles",
               deck("water_fsi", {**WATER2D, "kernel": "wendland", "steps": 60}), job.turns),
        *ranks(job.kept, "elastic gate, dx = 1 mm, to 0.1 s",
               bundled("elastic_gate", tend=0.1, frames=25), job.turns), memory(job.kept)]
    draw(job.folder / "peers.png", rows)
    job.write(COLUMNS, rows, 5, page(rows))
    return 0


if __name__ == "__main__":
    start("cost", main)
