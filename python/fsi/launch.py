"""How LAMMPS is started: command line and environment, for scenes, tests and benchmarks alike."""

import os
import shutil
import subprocess
from functools import lru_cache

from . import paths


def cores():
    """Number of processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@lru_cache(maxsize=None)
def _is_open_mpi():
    answer = subprocess.run(["mpirun", "--version"], capture_output=True, text=True, check=False)
    return "Open MPI" in answer.stdout


def mpirun(ranks):
    """The launcher's part of the command line, as a list."""
    if shutil.which("mpirun") is None:
        raise FileNotFoundError("mpirun is not on the PATH: tools/setup installs it")
    command = ["mpirun", "-np", str(ranks)]
    if _is_open_mpi():
        # unbound: two runs side by side would otherwise be bound to the same cores
        command += ["--bind-to", "none"]
        if ranks > cores():
            command += ["--oversubscribe"]
    return command


def lammps(deck, ranks=1, variables=None, binary=None):
    """The command line that runs a deck; ranks 0: one process, without the launcher; `variables`
    maps names to values for LAMMPS' -var."""
    command = [*(mpirun(ranks) if ranks else ()), str(binary or paths.BUILD / "lmp"), "-in",
               str(deck), "-log", "log.lammps"]
    for name, value in (variables or {}).items():
        command += ["-var", name, str(value)]
    return command


def callgrind(out, parts=False):
    """What goes before a command line to count the instructions of LAMMPS' time loop; parts: out.N
    of each run but the last, which is `out`."""
    loop = "LAMMPS_NS::Verlet::run(int)"
    return ["valgrind", "--tool=callgrind", f"--toggle-collect={loop}",
            f"--callgrind-out-file={out}",
            *((f"--dump-before={loop}", "--combine-dumps=no") if parts else ())]


def environment():
    """A copy of this process' environment with what LAMMPS, its Python module and Open MPI need."""
    env = dict(os.environ)
    env["LAMMPS_POTENTIALS"] = str(paths.POTENTIALS)
    env["OMP_NUM_THREADS"] = "1"
    env["LD_LIBRARY_PATH"] = _prepend(str(paths.BUILD), env.get("LD_LIBRARY_PATH"))
    # Open MPI refuses root, which is the only user in most containers, unless told twice
    env["OMPI_ALLOW_RUN_AS_ROOT"] = env["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1"
    python_path = _prepend(str(paths.ROOT / "python"), env.get("PYTHONPATH"))
    if (paths.BUILD / "CMakeCache.txt").exists():
        python_path = _prepend(str(paths.lammps_source() / "python"), python_path)
    env["PYTHONPATH"] = python_path
    return env


def _prepend(first, rest):
    return first + os.pathsep + rest if rest else first
