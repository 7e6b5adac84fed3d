"""What the tools of this folder have in common: command lines, results that are kept, tables."""

import contextlib
import csv
import hashlib
import io
import json
import sys
from datetime import date
from functools import cached_property, partial
from pathlib import Path

import measure

from fsi import paths, scene, sweep
from fsi.command import split, whole

PAGE = paths.ROOT / "doc" / "cost"
say = partial(print, flush=True)


class Kept:
    """Results by what they and the build are made of, as JSON in a folder: what has been measured
    is not measured again."""

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
        return measure.Pair(**self.get(["pair", *map(str, arguments)],
                                       lambda: vars(measure.pair(*arguments))))


def left(deck, name, settings):
    """The folder in which tools/run left a case of a scene with these settings of its deck, of this
    commit; None if it did not."""
    wanted = deck.normal(settings)
    found = (scene.left(name, case) for case, run in scene.cases(name).items() if not run["deck"]
             and deck.normal(run["variables"]) == wanted)
    return next(filter(None, found), None)


def figures_of(folder):
    """{figure: its value} of an analyzed run, references included."""
    figures = json.loads((folder / "summary.json").read_text())["figures"]
    references = {f"{f['name']} reference": f["reference"] for f in figures if f["reference"]}
    return {f["name"]: f["value"] for f in figures} | references


def write_csv(path, command, columns, rows, digits=None):
    """Columns of some rows, {column: value}, below a line that says what wrote them; digits: of all
    floating-point numbers."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        file.write(
            f"# {command}; commit {scene.commit() or 'unknown'}, {date.today().isoformat()}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([f"{v:.{digits}g}" if digits and isinstance(v, float) else v
                          for v in map(row.get, columns)] for row in rows)


def as_csv(rows):
    """Rows as the text of a table of the manual."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def read_csv(path):
    """The rows of such a table, {column: number, text or None}."""
    def value(text):
        with contextlib.suppress(ValueError):
            return float(text)
        return {"": None, "True": True, "False": False}.get(text, text)
    with open(path, newline="", encoding="utf-8") as file:
        return [{column: value(text) for column, text in row.items()}
                for row in csv.DictReader(line for line in file if not line.startswith("#"))]


class Job:
    """A tool's command line, `turns` being what it is where it may be given; brings the build up to
    date.

    chosen: those of the `words` that were given; folder: of table and page, and of what is kept.
    """

    def __init__(self, name, arguments, turns=None, words=()):
        forms = ["out=FOLDER", *["turns=N"] * bool(turns), *[f"some of {', '.join(words)}"]
                 * bool(words)]
        self.chosen = [a for a in arguments if a in words]
        options, _ = split([a for a in arguments if a not in words],
                           ("out", "turns")[:1 + bool(turns)], " or ".join(forms), more=False)
        self.turns = whole("turns", options.get("turns", str(turns or 1)))
        if not scene.build():
            sys.exit(1)
        self.name, self.folder = name, Path(
            options.get("out", paths.RESULTS / "cost" / name)).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)

    @cached_property
    def kept(self):
        """What was measured before."""
        return Kept(self.folder / "points")

    def write(self, columns, rows, digits, text):
        """The table and its page; tools/renew takes the table to doc/cost and makes the page and
        its picture there."""
        write_csv(self.folder / f"{self.name}.csv",
                  " ".join(["tools/cost", self.name, *self.chosen]), columns, rows, digits)
        (self.folder / f"{self.name}.md").write_text(text, encoding="utf-8")
        say(f"cost: table and page are in {self.folder}")
