"""Reference logs of the scenes' short forms, their pictures, and the gallery in the manual. The command line of tools/gallery.

    tools/gallery                 all scenes, then the page
    tools/gallery SCENE ...       these, then the page
    tools/gallery page            the page alone

Runs what examples/short.json says of a scene on 1 and 2 ranks and writes examples/SCENE/log.DATE.SCENE.RANKS (DATE of LAMMPS, as in LAMMPS'
own examples). Pictures that a scene's README shows are renewed from results/SCENE where tools/run has left some. Writes doc/src/gallery.rst.
"""

import json
import re
import shutil
import subprocess
import sys
import tempfile
from datetime import datetime
from pathlib import Path

from . import launch, log, paths, scene
from .command import Refusal, start
from .results import _pictures, _readme

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
    """A log without the places of this machine."""
    text = text.replace(f"{paths.ROOT}/", "").replace(str(paths.ROOT), ".")
    return re.sub(r"(?<![\w.])/(?:[\w.+-]+/)+", "", text)


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


def renew_pictures(name):
    """Those of the README from what tools/run left."""
    folder = paths.RESULTS / name
    summary = folder / "summary.json"
    if summary.exists():
        for picture in _pictures(name, folder, json.loads(summary.read_text())):
            shutil.copyfile(folder / picture["file"], paths.EXAMPLES / name / Path(picture["file"]).name)


def page():
    """doc/src/gallery.rst, from READMEs, pictures and reference logs; starters first."""
    lines = [".. Written by tools/gallery; edits are lost.", "", "Gallery", "=======", "",
             "Each scene runs with ``tools/run NAME``; its folder ``examples/NAME`` holds deck, README with what to expect, and reference logs of a short",
             "form, ``log.DATE.NAME.RANKS``, with the settings given here. What all of them give is on the page of :doc:`results <../results/README>`. Times",
             "are those of the short forms' loop on 1 and 2 ranks, on a machine with other work: an order of magnitude.", "",
             ".. container:: cards", ""]
    readmes = {name: _readme(name) for name in paths.scenes()}
    names = sorted(readmes, key=lambda name: ("starter" not in readmes[name]["description"], name))
    for name in names:
        lines += ["   .. container:: card", ""]
        picture = re.search(r"!\[([^\]]*)\]\(([^)\s/]+)\)", (paths.EXAMPLES / name / "README.md").read_text())
        if picture and (paths.EXAMPLES / name / picture[2]).exists():
            lines += [f"      .. image:: ../../examples/{name}/{picture[2]}", f"         :alt: {picture[1]}",
                      f"         :target: ../../examples/{name}/README.html", ""]
        runs = [log.read(path).finished[-1] for ranks in RANKS for path in sorted((paths.EXAMPLES / name).glob(f"log.*.{name}.{ranks}"))]
        settings = "".join(f" {k}={v}" for k, v in short().get(name, {}).items())
        cost = (f": {runs[0].atoms:,} particles, {runs[0].steps:,} steps, " + ", ".join(f"{run.loop_seconds:.1f} s on {run.ranks}" for run in runs)) if runs else ""
        lines += [f"      :doc:`{readmes[name]['title']} <../../examples/{name}/README>`. {_rst(readmes[name]['description'])}", "",
                  f"      ``tools/run {name}{settings if runs else ''}``{cost}.", ""]
    lines += [".. toctree::", "   :hidden:", "", *(f"   ../../examples/{name}/README" for name in names)]
    (paths.ROOT / "doc/src/gallery.rst").write_text("\n".join(lines) + "\n")


def _rst(text):
    """One paragraph of Markdown: code in double backquotes, links as their text."""
    return re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"`([^`]+)`", r"``\1``", text))


def main(arguments):
    """tools/gallery"""
    if any(word.startswith("-") for word in arguments):
        sys.exit(__doc__)
    wanted = [] if arguments == ["page"] else arguments or sorted(short())
    unknown = [name for name in wanted if name not in short()]
    if unknown:
        raise Refusal(f"examples/{SHORT} has no {', '.join(unknown)}; it has {', '.join(short())}")
    failed = []
    if wanted and not scene.build():
        return 1
    for name in wanted:
        if not reference_logs(name):
            failed.append(name)
        renew_pictures(name)
    page()
    if failed:
        print("gallery: failed:", *failed, file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    start("gallery", main)
