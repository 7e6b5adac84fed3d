"""Runs the scenes in examples/: builds, simulates, analyses. The command line of tools/run.

Each scene is a folder with a deck in.<scene> and an analyze.py whose main(folder) writes summary.json and pictures.
"""

import difflib
import importlib.util
import json
import re
import subprocess
import sys
import time
from pathlib import Path

from . import launch, paths
from .summary import RUN_FILE

OPTIONS = ("ranks", "out")
MADE_FILE = ".made-by-tools-run"


class Refusal(Exception):
    """Something to tell the user, without a traceback."""


def scenes():
    """Names of the scenes, sorted."""
    return sorted(f.name for f in paths.EXAMPLES.iterdir() if (f / f"in.{f.name}").is_file())


def deck(scene):
    """The scene's input file."""
    return paths.EXAMPLES / scene / f"in.{scene}"


def deck_variables(path):
    """Names and defaults of what -var can set in a deck: its index-style variables."""
    found = {}
    for line in Path(path).read_text().splitlines():
        match = re.match(r"\s*variable\s+(\w+)\s+index\s+(\S+)", line)
        if match:
            found.setdefault(match[1], match[2].strip("\"'"))
    return found


def parse(arguments):
    """Splits NAME=VALUE arguments into (options of this tool, LAMMPS variables)."""
    options, variables = {}, {}
    for argument in arguments:
        name, equals, value = argument.partition("=")
        if not equals or not name or not value:
            raise Refusal(f"'{argument}' is not of the form NAME=VALUE, such as ranks=2")
        (options if name in OPTIONS else variables)[name] = value
    ranks = options.get("ranks", str(min(2, launch.cores())))
    if not ranks.isdecimal() or int(ranks) < 1:
        raise Refusal(f"ranks={ranks}: a whole number of MPI ranks is needed, 1 or more")
    options["ranks"] = int(ranks)
    return options, variables


def check(scene, variables):
    """Refuses a scene or a variable that does not exist, and words where the deck's default is a number."""
    if scene not in scenes():
        listed = ", ".join(scenes()) or "none"
        raise Refusal(f"there is no scene '{scene}'{_similar(scene, scenes())}. Scenes: {listed}")
    known = deck_variables(deck(scene))
    for name, value in variables.items():
        if name not in known:
            listed = ", ".join(f"{n}={default}" for n, default in known.items()) or "none"
            raise Refusal(f"{scene} has no variable '{name}'{_similar(name, [*known, *OPTIONS])}. "
                          f"Its variables and their defaults: {listed}. Options: ranks=N, out=FOLDER")
        if _is_number(known[name]) and not _is_number(value):
            raise Refusal(f"{name}={value}: a number is needed, such as the default {known[name]}")


def run(scene, folder, ranks, variables):
    """Simulates and analyses a scene in `folder`; returns LAMMPS' exit status, 0 if all went well."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    _clear(folder)
    before = _files(folder)
    try:
        given = "".join(f" {name}={value}" for name, value in variables.items())
        print(f"run: {scene}{given} ranks={ranks}, results in {folder}", flush=True)
        status, wall, output = _simulate(scene, folder, ranks, variables)
        if status != 0:
            _explain(folder, status, output)
            return status
        record = {"scene": scene, "ranks": ranks, "wall_seconds": round(wall, 3),
                  "variables": {**deck_variables(deck(scene)), **variables}}
        (folder / RUN_FILE).write_text(json.dumps(record, indent=2) + "\n")
        print(f"run: LAMMPS took {wall:.1f} s; analysing", flush=True)
        analyse(scene, folder)
        print(f"run: figures, pictures and log are in {folder}", flush=True)
        return 0
    finally:
        made = sorted(_files(folder) - before - {MADE_FILE})
        (folder / MADE_FILE).write_text("".join(f"{name}\n" for name in made))


def analyse(scene, folder):
    """Calls main(folder) of the scene's analyze.py, if it has one."""
    path = paths.EXAMPLES / scene / "analyze.py"
    if not path.exists():
        return
    spec = importlib.util.spec_from_file_location(f"fsi_analyze_{scene}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.main(folder)


def _simulate(scene, folder, ranks, variables):
    """Runs LAMMPS, its output going to the terminal; returns (status, wall seconds, last lines)."""
    command = launch.lammps(deck(scene), ranks, variables)
    started = time.perf_counter()
    tail = []
    with subprocess.Popen(command, cwd=folder, env=launch.environment(), stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace") as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            tail = [*tail[-199:], line.rstrip()]
    return process.returncode, time.perf_counter() - started, tail


def _explain(folder, status, output):
    """Says why LAMMPS failed, in its own words."""
    errors = list(dict.fromkeys(line for line in output if "ERROR" in line or line.startswith("Last ")))
    print(f"\nrun: LAMMPS failed (status {status}); the log is {folder / 'log.lammps'}", file=sys.stderr)
    for line in errors or output[-5:]:
        print(f"  {line}", file=sys.stderr)


def _files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}


def _clear(folder):
    """Removes what an earlier run left, and nothing else: the folder may be the user's own."""
    listing = folder / MADE_FILE
    if listing.exists():
        for name in listing.read_text().splitlines():
            path = (folder / name).resolve()
            if folder.resolve() in path.parents:
                path.unlink(missing_ok=True)


def _similar(name, known):
    close = difflib.get_close_matches(name, known, n=1)
    return f" (did you mean '{close[0]}'?)" if close else ""


def _is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def main(arguments):
    """tools/run with at least one argument."""
    if not arguments:
        raise Refusal("which scene? " + ", ".join(scenes()))
    wanted = scenes() if arguments[0] == "all" else [arguments[0]]
    options, variables = parse(arguments[1:])
    for scene in wanted:
        check(scene, variables)
    out = Path(options["out"]).resolve() if "out" in options else None
    if subprocess.run([str(paths.ROOT / "tools" / "setup")], check=False).returncode != 0:
        return 1

    statuses = {}
    for scene in wanted:
        folder = paths.RESULTS / scene if out is None else out / scene if arguments[0] == "all" else out
        statuses[scene] = run(scene, folder, options["ranks"], variables)
    failed = [scene for scene, status in statuses.items() if status != 0]
    if len(wanted) > 1:
        print(f"run: {len(wanted) - len(failed)} scenes ran, {len(failed)} failed", *failed)
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Refusal as refusal:
        sys.exit(f"run: {refusal}")
    except KeyboardInterrupt:
        sys.exit(130)
