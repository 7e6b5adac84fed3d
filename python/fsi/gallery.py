"""Reference logs of the scenes' short forms, and the gallery in the manual. The command line of tools/gallery.

    tools/gallery                 all scenes
    tools/gallery SCENE ...       these

Runs what examples/short.json says of a scene on 1 and 2 ranks and writes examples/SCENE/log.DATE.SCENE.RANKS (DATE of LAMMPS, as in LAMMPS'
own examples). The page doc/src/gallery.rst is one of those that tools/renew writes.
"""

import json
import re
import subprocess
import sys
import tempfile
from datetime import datetime
from pathlib import Path

from . import launch, log, paths, scene
from .command import Refusal, start
from .results import title

SHORT = "short.json"
RANKS = (1, 2)


def short():
    """{scene: variables of its short form}"""
    return {name: {k: str(v) for k, v in variables.items()}
            for name, variables in json.loads((paths.EXAMPLES / SHORT).read_text()).items()}


def date(version):
    """LAMMPS' version as its examples write it in the names of logs: 4 Feb 2025 is 4Feb25."""
    day = datetime.strptime(version.split(" - ")[0], "%d %b %Y")
    return f"{day.day}{day.strftime('%b%y')}"


def scrubbed(text):
    """A log without the places of this machine, and what is said of progress every few seconds; a / after a number, a variable or a bracket
    divides."""
    text = text.replace(f"{paths.ROOT}/", "").replace(str(paths.ROOT), ".")
    text = re.sub(r"  fsi/pack: \d+ of .*\n", "", text)
    return re.sub(r"(?<![\w.)}\]])/(?:[\w.+-]+/)+", "", text)


def reference_logs(name):
    """Runs the short form on 1 and 2 ranks; whether that worked."""
    variables = short()[name]
    for ranks in RANKS:
        with tempfile.TemporaryDirectory() as folder:
            print(f"gallery: {name} on {ranks}", flush=True)
            done = subprocess.run(launch.lammps(scene.deck(name), ranks, variables), cwd=folder, env=launch.environment(),
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", check=False)
            if done.returncode != 0:
                print(done.stdout[-1000:], file=sys.stderr)
                return False
            text = (Path(folder) / "log.lammps").read_text(errors="replace")
            target = paths.EXAMPLES / name
            for old in target.glob(f"log.*.{name}.{ranks}"):
                old.unlink()
            (target / f"log.{date(log.read(Path(folder) / 'log.lammps').version)}.{name}.{ranks}").write_text(scrubbed(text))
    return True


def description(name):
    """The first line of a scene's README that is no heading."""
    return next(line for line in (paths.EXAMPLES / name / "README.md").read_text().splitlines() if line.strip() and not line.startswith("#"))


def pictures(name):
    """[(alternative text, file)] that a scene's README shows of its folder."""
    return re.findall(r"!\[([^\]]*)\]\(([^)\s/]+)\)", (paths.EXAMPLES / name / "README.md").read_text())


def page():
    """The text of doc/src/gallery.rst, from READMEs and pictures; starters first."""
    lines = [".. Written by tools/renew; edits are lost.", "", "Gallery", "=======", "",
             "Each scene runs with ``tools/run NAME``, with the name in brackets. Its page says what to expect.", "",
             ".. container:: cards", ""]
    names = sorted(paths.examples(), key=lambda name: ("starter" not in description(name), name))
    for name in names:
        lines += ["   .. container:: card", ""]
        shown = [found for found in pictures(name) if (paths.EXAMPLES / name / found[1]).exists()]
        if shown:
            lines += [f"      .. image:: ../../examples/{name}/{shown[0][1]}", f"         :alt: {shown[0][0]}",
                      f"         :target: ../../examples/{name}/README.html", ""]
        lines += [f"      :doc:`{title(name)} <../../examples/{name}/README>` (``{name}``)", ""]
    return "\n".join([*lines, ".. toctree::", "   :hidden:", "", *(f"   ../../examples/{name}/README" for name in names)]) + "\n"


def main(arguments):
    """tools/gallery"""
    if any(word.startswith("-") for word in arguments):
        sys.exit(__doc__)
    wanted = arguments or sorted(short())
    unknown = [name for name in wanted if name not in short()]
    if unknown:
        raise Refusal(f"examples/{SHORT} has no {', '.join(unknown)}; it has {', '.join(short())}")
    if not scene.build():
        return 1
    failed = [name for name in wanted if not reference_logs(name)]
    if failed:
        print("gallery: failed:", *failed, file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    start("gallery", main)
