"""Numbers that are typed by hand into the results of scenes' pages, compared with the data.
usage: typed_numbers.py [COMMIT]

Lists those whose data have changed since COMMIT (HEAD by default), with page and line, what the
page says, and what the data say now. A number is found by its value, so several figures may stand
behind one. Where one of them has not changed the line begins with "perhaps". tools/renew ends with
this list.
"""

import csv
import io
import json
import re
import subprocess
import sys
from dataclasses import dataclass
from functools import cache

from fsi import paths

# Columns and rows of tables of scenes' pages that hold no figures of a run
ASIDE = re.compile(
    r"reference|source|bound|published|experiment|code|et al\.|\band [A-Z]|particles along|time \[")
NUMBER = re.compile(r"(?<![\w.^/])(?!1/s)(\d[\d,]*(?<!,)(?:\.\d+)?(?:e-?\d+)?)(?![\w.]*\w)")
# what follows a number of per cent, or of a list of them
SHARE = re.compile(r"(?:[,;] [-+]?[\d.]+)* %")
CLOCK = re.compile(r" (?:s|min)\b")
SCALES = (1e-3, 1.0, 1e3, 1e6)  # a page may give another prefix of the unit


@dataclass
class Typed:
    """A number on a page."""
    line: int
    text: str
    share: bool     # per cent
    clock: bool     # a time that a run took
    row: str        # the line that it is in
    beside: tuple   # all numbers of that line

    def fits(self, kind, value):
        """Whether this is that value of the data, rounded to its own digits"""
        number, off = spread(self.text)
        if self.clock or kind == "time":
            scales = (1.0, 1 / 60) if self.clock and kind == "time" else ()
        elif self.share:
            scales = (100.0,)
        else:
            scales = () if kind == "share" else SCALES
        return any(abs(number - scale * abs(value)) <= off for scale in scales)

    def said(self, value):
        """That value as this number would be written"""
        number, _ = spread(self.text)
        mantissa, power, _ = self.text.replace(",", "").partition("e")
        scale = min((100.0, 1 / 60, *SCALES), key=lambda s: abs(number - s * abs(value)))
        digits = len(mantissa.partition(".")[2])
        return (f"{scale * abs(value):.{digits}e}" if power else f"{scale * abs(value):,.{digits}f}"
                if "," in self.text else f"{scale * abs(value):.{digits}f}")


def spread(text):
    """(number, how far it may be off for its last digit); 42,000 is of two digits, as written in
    prose"""
    mantissa, _, power = text.replace(",", "").partition("e")
    zeros = len(mantissa) - len(mantissa.rstrip("0")) if "," in text else 0
    return float(f"{mantissa}e{power or 0}"), 0.501 * 10.0 ** (int(power or 0) + zeros
                                                               - len(mantissa.partition(".")[2]))


def results_of(text):
    """[(line number, line)] of a page's part on results"""
    lines = text.splitlines()
    begin = lines.index("## Results")
    end = next((k for k in range(begin + 1, len(lines)) if lines[k].startswith("## References")),
               len(lines))
    return [(k + 1, lines[k]) for k in range(begin + 1, end)]


def in_tables(text):
    """Numbers of the tables of results, those of columns that hold figures of runs."""
    heads, found = None, []
    for number, line in results_of(text):
        if line.startswith("## "):
            break
        cells = [cell.strip() for cell in line.strip("|").split("|")] if line.startswith(
            "|") else None
        if heads and cells and set(line) - set("|-: "):
            row = tuple(n for cell in cells for n in NUMBER.findall(cell))
            for head, cell in zip(heads[1:], cells[1:]):
                if not ASIDE.search(head):
                    clock = any("CPU" in words for words in (head, *cells))
                    found += [Typed(number, m[1], bool(SHARE.match(cell, m.end())),
                                    clock and bool(CLOCK.match(cell, m.end())), line, row)
                              for m in NUMBER.finditer(cell)]
        heads = heads if heads and cells else cells
    return found


def in_prose(text):
    """Numbers of the text on results and deviations that may be figures of a run: per cents, and
    those with a point."""
    return [Typed(number, m[1], bool(SHARE.match(line, m.end())), False, line, ())
            for number, line in results_of(text)
            if not line.startswith(("|", "!")) for m in NUMBER.finditer(
                re.sub(r"`[^`]*`|\]\([^)]*\)", lambda code: " " * len(code[0]), line))
            if "." in m[1] or SHARE.match(line, m.end())]


def data_of(scene, read):
    """[(name, kind, value)] of all that commands wrote of a scene, in its results and its sweep.
    read: text of a file of doc, or None"""
    summary = json.loads(read("results/results.json"))["scenes"].get(scene, {}).get("summary")
    if summary is None:
        return []
    found = [(f["name"], kind, f[key]) for f in summary["figures"] if f["name"] != "cpu_seconds"
             for key, kind in (("value", "value"), ("reference", "value"),
                               ("relative_error", "share"))]
    for name, case in [("all cases", summary), *summary.get("cases", {}).items()]:
        found += [(name, "count", case["particles"]), (name, "time", case["cpu_seconds"])]
    if table := read(f"cost/{scene}.csv"):
        rows = csv.DictReader(line for line in io.StringIO(table) if not line.startswith("#"))
        found += [(f"{row['label']} of the sweep", kind, float(row[key])) for row in rows
                  for key, kind in (("value", "value"), ("error", "share")) if row[key]]
    return [(name, kind, value) for name, kind, value in found if value is not None]


def here(name):
    path = paths.ROOT / "doc" / name
    return path.read_text(encoding="utf-8") if path.exists() else None


def there(commit):
    @cache
    def read(name):
        done = subprocess.run(["git", "-C", str(paths.ROOT), "show", f"{commit}:doc/{name}"],
                              capture_output=True, text=True, check=False)
        return done.stdout if done.returncode == 0 else None
    return read


def changed(text, old, new):
    """[(number, {what it is now: names})] of a page whose data were `old` and are `new`"""
    now = {(name, kind, which): value for which, (name, kind, value) in numbered(new)}
    found = []
    for number in in_tables(text) + in_prose(text):
        says = {}
        for which, (name, kind, value) in numbered(old):
            if number.fits(kind, value):
                after = now.get((name, kind, which))
                says.setdefault("gone" if after is None else number.text if number.fits(kind, after)
                                else number.said(after), set()).add(name)
        if set(says) - {number.text}:
            found.append((number, says))
    return found


def numbered(data):
    """Each with how many of its name and kind came before"""
    seen = {}
    for entry in data:
        seen[entry[:2]] = which = seen.get(entry[:2], -1) + 1
        yield which, entry


def report(commit):
    """[what to compare]: numbers all of whose figures have changed first, then those with other
    figures of their value."""
    sure, perhaps, before = [], [], there(commit)
    for page in sorted(paths.EXAMPLES.glob("*/README.md")):
        scene = page.parent.name
        for number, says in changed(page.read_text(encoding="utf-8"), data_of(scene, before),
                                    data_of(scene, here)):
            now = "; ".join(f"{value} ({', '.join(sorted(names))})" for value, names in says.items()
                            if value != number.text)
            (perhaps if number.text in says else sure).append(
                f"{page.relative_to(paths.ROOT)}:{number.line}: {number.text} -> {now}")
    return sure + [f"perhaps {line}" for line in perhaps]


if __name__ == "__main__":
    print("\n".join(report(sys.argv[1] if len(sys.argv) > 1 else "HEAD")))
