"""Shows that a change of the sources changes no number: hashes of the restart files that scenes
leave after some steps."""

import argparse
import hashlib
import json
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from . import launch, paths
from .check import spelled_out

STEPS = 100
FEWER = 10  # of decks with so many particles that more would take minutes
LARGE = {"cylinder_channel", "cylinder_free", "dam_break", "dam_break_3d", "dam_break_elastic",
         "elastic_gate",
         "flexible_plate", "hydrostatic_plate", "open_channel", "plate_crossflow", "ring_annulus",
         "rolling_tank",
         "sphere", "taylor_bar", "turek_hron_fsi"}
# name: (ranks, what the deck begins with)
FORMS = {"1 rank": (1, ""), "2 ranks": (2, ""), "newton off": (1, "newton off\n")}


def decks():
    """All that are to be copied, short forms of the studies, and recipes: {name: (path, variables,
    steps)}."""
    short = json.loads((paths.EXAMPLES / "short.json").read_text())
    found = {}
    for path in sorted(paths.EXAMPLES.glob("*/in.*")):
        found[f"{path.parent.name}/{path.name}"] = (path, {}, FEWER if path.parent.name in LARGE
                                                    else STEPS)
    for path in sorted(paths.EXAMPLES.glob("*/study/in.*")):
        found[f"{path.parents[1].name}/study"] = (path, short.get(path.parents[1].name, {}), STEPS)
    for path in sorted((paths.ROOT / "doc/src/recipes").glob("in.*")):
        found[f"recipes/{path.name}"] = (path, {}, STEPS)
    return found


def begun(text, steps, head):
    """The deck up to its first run, which takes some steps and leaves a restart file."""
    before = re.split(r"^\s*run\s+(?!0\b)", spelled_out(text), maxsplit=1, flags=re.M)[0]
    return f"{head}{before}\nrun {steps}\nwrite_restart left.restart\n"


def hashed(name, form, binary):
    """The hash of what the deck leaves, or why there is none."""
    path, variables, steps = decks()[name]
    ranks, head = FORMS[form]
    with tempfile.TemporaryDirectory() as folder:
        for file in path.parent.iterdir():
            if file.is_file():
                shutil.copy(file, folder)
        Path(folder, "in.begun").write_text(begun(path.read_text(), steps, head))
        command = launch.lammps("in.begun", ranks if ranks > 1 else 0, variables, binary)
        done = subprocess.run(command, cwd=folder,
                              env={**launch.environment(), "LD_LIBRARY_PATH": str(binary.parent)},
                              stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              errors="replace", check=False)
        left = Path(folder, "left.restart")
        if done.returncode or not left.exists():
            error = re.findall(r"^ERROR.*", done.stdout, re.M)
            return error[0] if error else f"status {done.returncode}"
        return hashlib.sha256(left.read_bytes()).hexdigest()


def main(argv=None):
    """python3 -m fsi.proof FILE: writes the hashes, or compares with those that are there."""
    parser = argparse.ArgumentParser(prog="tools/proof", description=__doc__)
    parser.add_argument("file", type=Path,
                        help="hashes, which are made if it is not there and else compared")
    parser.add_argument("--only", default="", help="expression that names of decks match")
    args = parser.parse_args(argv)
    binary = paths.BUILD / "lmp"
    todo = [(name, form) for name in decks() if re.search(args.only, name) for form in FORMS]
    with ThreadPoolExecutor(launch.cores()) as pool:
        found = dict(zip((f"{name}, {form}" for name, form in todo),
                         pool.map(lambda one: hashed(*one, binary), todo)))
    if not args.file.exists():
        args.file.write_text(json.dumps(found, indent=1) + "\n")
        print(f"{len(found)} hashes in {args.file}",
              *(f"{k}: {v}" for k, v in found.items() if len(v) != 64), sep="\n")
        return 0
    before = json.loads(args.file.read_text())
    other = [name for name, value in found.items() if before.get(name) != value]
    print(*(f"{name}: {before.get(name, 'new')[:60]} -> {found[name][:60]}" for name in other),
          f"{len(found) - len(other)} of {len(found)} as before", sep="\n")
    return bool(other)


if __name__ == "__main__":
    sys.exit(main())
