"""What the tools of this folder have in common: command lines, results that are kept, tables."""

import csv
import hashlib
import json
import sys
from functools import cached_property, partial
from pathlib import Path

import measure

from fsi import paths, scene, sweep
from fsi.command import split, whole

PAGE = paths.ROOT / "doc" / "cost"
say = partial(print, flush=True)


class Kept:
    """Results by what they and the build are made of, as JSON in a folder: what has been measured is not measured again."""

    def __init__(self, folder):
        self.folder, self.version = folder, [sweep.source_hash()]
        self.folder.mkdir(parents=True, exist_ok=True)

    def get(self, key, make):
        """The stored result of `key`; else that of make()."""
        name = hashlib.sha1(json.dumps([key, self.version]).encode()).hexdigest()[:16]
        path = self.folder / f"{name}.json"
        return json.loads(path.read_text()) if path.exists() else sweep.put(path, make())

    def pair(self, *arguments):
        """measure.pair() of these."""
        return measure.Pair(**self.get(["pair", *map(str, arguments)], lambda: vars(measure.pair(*arguments))))


def write_csv(path, columns, rows, digits=None):
    """Columns of some rows, {column: value}; digits: of all floating-point numbers."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([f"{v:.{digits}g}" if digits and isinstance(v, float) else v for v in map(row.get, columns)] for row in rows)


def stamped(page):
    """The page, with the commit that it was made of below its heading."""
    heading, _, text = page.partition("\n\n")
    return f"{heading}\n\nOf commit {scene.commit() or 'unknown'}.\n\n{text}"


class Job:
    """A tool's command line, `turns` being what it is where it may be given; brings the build up to date.

    chosen: those of the `words` that were given; folder: of what is kept; target: of page, pictures and table.
    """

    def __init__(self, name, arguments, turns=None, words=()):
        forms = ["out=FOLDER", *["turns=N"] * bool(turns), *[f"some of {', '.join(words)}"] * bool(words)]
        self.chosen = [a for a in arguments if a in words]
        options, _ = split([a for a in arguments if a not in words], ("out", "turns")[:1 + bool(turns)], " or ".join(forms), more=False)
        self.turns = whole("turns", options.get("turns", str(turns or 1)))
        if not scene.build():
            sys.exit(1)
        self.name, self.folder = name, Path(options.get("out", paths.RESULTS / "cost" / name)).resolve()
        self.target = self.folder if "out" in options or self.chosen else PAGE
        self.target.mkdir(parents=True, exist_ok=True)

    @cached_property
    def kept(self):
        """What was measured before."""
        return Kept(self.folder / "points")

    def write(self, columns, rows, digits, text, everything=None):
        """The table, the page with its commit, and as JSON beside what is kept `everything`; what a table of its own is called."""
        if everything is not None:
            (self.folder / f"{self.name}.json").write_text(json.dumps(everything, indent=1) + "\n")
        write_csv(self.target / f"{self.name}.csv", columns, rows, digits)
        (self.target / f"{self.name}.md").write_text(stamped(text), encoding="utf-8")
