"""Reference logs of the scenes' short forms, and the gallery in the manual. The command line of
tools/gallery.

    tools/gallery                 all scenes
    tools/gallery SCENE ...       these

Runs what examples/short.json says of a scene on 1 and 2 ranks and writes
examples/SCENE/log.DATE.SCENE.RANKS (DATE of LAMMPS, as in LAMMPS' own examples). The page
doc/src/gallery.rst is one of those that tools/renew writes.
"""

import json
import re
import subprocess
import sys
import tempfile
import textwrap
from datetime import datetime
from pathlib import Path

from . import launch, log, paths, results, scene
from .command import Refusal, start

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
    """A log without the places of this machine, what to cite, histograms over ranks, and what is
    said of progress every few seconds; a / after a number, a variable or a bracket divides."""
    text = text.replace(f"{paths.ROOT}/", "").replace(str(paths.ROOT), ".")
    text = re.sub(r"  fsi/pack: \d+ of .*\n", "", text)
    text = re.sub(r"Histogram: .*\n|[ \t]+$", "", text, flags=re.M)
    text = re.sub(r"\nCITE-.*?\nCITE-\S+\n\n", "", text, flags=re.S)
    return re.sub(r"(?<![\w.)}\]])/(?:[\w.+-]+/)+", "", text)


def reference_logs(name):
    """Runs the short form on 1 and 2 ranks; whether that worked."""
    variables = short()[name]
    for ranks in RANKS:
        with tempfile.TemporaryDirectory() as folder:
            print(f"gallery: {name} on {ranks}", flush=True)
            done = subprocess.run(launch.lammps(scene.deck(name), ranks, variables), cwd=folder,
                                  env=launch.environment(),
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                  errors="replace", check=False)
            if done.returncode != 0:
                print(done.stdout[-1000:], file=sys.stderr)
                return False
            text = (Path(folder) / "log.lammps").read_text(errors="replace")
            target = paths.EXAMPLES / name
            for old in target.glob(f"log.*.{name}.{ranks}"):
                old.unlink()
            (target
             / f"log.{date(log.read(Path(folder) / 'log.lammps').version)}.{name}.{ranks}"
              ).write_text(scrubbed(text))
    return True


def description(name):
    """The first line of a scene's README that is no heading."""
    return next(line for line in (paths.EXAMPLES / name / "README.md").read_text().splitlines()
                if line.strip() and not line.startswith("#"))


def pictures(name):
    """[(alternative text, file)] that a scene's README shows of its folder."""
    return re.findall(r"!\[([^\]]*)\]\(([^)\s/]+)\)",
                      (paths.EXAMPLES / name / "README.md").read_text())


def figure_of(name, found):
    """What a card says of accuracy and time: the main quantity of the scene, or of the first of
    several."""
    row = next((row for rows in results.main_figures().values() for row in rows.get(name, [])),
               None)
    of = row and name in found and results.main_of(row, found[name])
    if not of:
        return ""
    figure = of[0]
    error = f"{row['words']} " + (f"{results.deviation(figure)} ({results.kind(figure['source'])})"
                                  if figure["reference"] else results.value(figure))
    return f"{error[0].upper()}{error[1:]}, {results.duration(max(1.0, of[1]))}."


def card(name, found):
    """Lines of a scene's card: picture, link, sentence, error and time."""
    page = f"../../examples/{name}/README.md"
    lines = ["   .. container:: card", ""]
    if shown := [one for one in pictures(name) if (paths.EXAMPLES / name / one[1]).exists()]:
        lines += [f"      .. image:: ../../examples/{name}/{shown[0][1]}",
                  f"         :alt: {shown[0][0]}", f"         :target: {page}", ""]
    lines += [f"      `{results.title(name)} <{page}>`__ (``{name}``)", ""]
    text = f"{description(name).replace('`', '``')} {figure_of(name, found)}"
    return [*lines, *textwrap.wrap(text, 140, initial_indent=" " * 6, subsequent_indent=" " * 6,
                                   break_on_hyphens=False), ""]


def page():
    """The text of doc/src/gallery.rst, from READMEs, pictures and results, in the order of
    examples/main.json."""
    found = results.ran({"scenes": results.scenes_of(paths.PAGE)})
    lines = [".. github display off", "", ".. Written by tools/renew; edits are lost.", "",
             "Gallery", "=======", "",
             "Each scene runs with ``tools/run NAME``, with the name in brackets.",
             "Each card gives the error of the main quantity, the kind of its reference, and the "
             "time on one core.", ""]
    names = []
    for group, scenes in results.main_figures().items():
        lines += [f"{group[0].upper()}{group[1:]}", "-" * len(group), "", ".. container:: cards",
                  ""]
        for name in scenes:
            lines += card(name, found)
        names += scenes
    return "\n".join([*lines, ".. toctree::", "   :hidden:", "",
                      *(f"   ../../examples/{name}/README" for name in names)]) + "\n"


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
