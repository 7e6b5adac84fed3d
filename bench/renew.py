"""Renews all measured pages of the manual. The command line of tools/renew, which says what it
does; nothing else writes these pages."""

import json
import re
import shutil
import sys
from pathlib import Path

import accuracy_cost
import cost_report
import effects
import evidence
import hard_pages
import largest
import peers
import presets
import ranks
import refusals
import robustness
import scaling
import solid_variants
import sound
import typed_numbers
from tool import PAGE, read_csv, say

from fsi import gallery, paths, quoted, results, scene
from fsi.command import Refusal, start

# of tools/cost, with a table in doc/cost
TOOLS = {"effects": effects, "solids": solid_variants, "peers": peers, "scaling": scaling,
         "ranks": ranks, "sound": sound}
WORDS = ("--no-runs", "--pages-only")


def sweeps():
    """Scenes that have a sweep of accuracy against time."""
    return [path.parent.name for path in sorted(paths.EXAMPLES.glob("*/cost.json"))]


# ---- runs ----

def run():
    """All that pages are made of; what is there of these sources is not run again. Returns what
    failed."""
    if (now := scene.commit()) is None or now.endswith("+"):
        raise Refusal(f"pages are of one commit, and the tree has changes ({now or 'no git'}): "
                      "commit them first")
    jobs = {"tools/run all": (scene, ["all"])}
    jobs |= {f"tools/cost {name}": (accuracy_cost, [name]) for name in sweeps()}
    jobs |= {f"tools/cost {name}": (program, []) for name, program in TOOLS.items()}
    jobs["tools/cost robustness"] = (robustness, [])
    failed = []
    for k, (command, (program, words)) in enumerate(jobs.items(), start=1):
        say(f"renew: {k} of {len(jobs)}: {command}")
        if program.main(words):
            failed.append(command)
    return failed


# ---- data ----

def tables():
    """{cost/NAME or hard: {a file in results: its place in doc}}, beside the data of scenes."""
    made = paths.RESULTS / "cost"
    found = {f"cost/{name}": {made / name / file: PAGE / f"{name}.{end}"
                              for file, end in (("points.csv", "csv"), ("summary.json", "json"))}
             for name in sweeps()}
    found |= {f"cost/{name}": {made / name / f"{name}.csv": PAGE / f"{name}.csv"} for name in TOOLS}
    return found | {"cost/robustness": {made / "robustness" / "robustness.csv": evidence.HARD
                                        / "robustness.csv"},
                    "hard": {paths.RESULTS / "hard" / name: evidence.HARD / name
                             for name in ("hard.json", "hard.csv", "thumbnails.png")}}


def by_name():
    """As tables(), of what is run and taken by its name alone: the largest run needs 21 GB."""
    return {"cost/largest": {paths.RESULTS / "cost/largest" / name: PAGE / name
                             for name in ("largest.csv", "largest.log")}}


def checked(wanted):
    """These files, all there and of a commit."""
    if missing := [str(path.relative_to(paths.ROOT)) for path in wanted if not path.exists()]:
        raise Refusal(f"{', '.join(missing)}: not there; tools/run and tools/cost make them")
    if unclear := [str(path.relative_to(paths.ROOT)) for path in wanted
                   if path.suffix in (".csv", ".json") and not stamp(path)]:
        raise Refusal(f"{', '.join(unclear)}: of no commit without changes")
    return wanted


def collect():
    """Takes to doc what the runs left in results."""
    found = results.collect(paths.RESULTS)
    wanted = checked({path: target for files in tables().values()
                      for path, target in files.items()})
    (paths.PAGE / "results.json").write_text(results.packed(found))
    for path, target in wanted.items():
        shutil.copyfile(path, target)
    for name in paths.examples():
        take_pictures(name)


def take_pictures(name):
    for _, file in gallery.pictures(name):
        if found := picture(name, file):
            shutil.copyfile(found, paths.EXAMPLES / name / file)


def take(wanted):
    """Takes to doc what results have of these: SCENE, cost/NAME, hard, each of one commit; all
    other data stay as they are."""
    page = paths.PAGE / "results.json"
    found, known = json.loads(page.read_text()), tables() | by_name()
    for what in wanted:
        files = checked(known.get(what, {}))
        for path, target in files.items():
            shutil.copyfile(path, target)
        if what in paths.scenes():
            path, = checked([paths.RESULTS / what / "summary.json"])
            found["scenes"][what] = {"summary": json.loads(path.read_text())}
            if what in paths.examples():
                take_pictures(what)
        elif not files:
            raise Refusal(f"'{what}' is neither a scene nor one of {', '.join(known)}")
    page.write_text(results.packed(found))


def stamp(path):
    """(commit, date) that a table or a summary names; None without a commit or with changes."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".json":
        found = json.loads(text)
        commit, date = found.get("commit"), found.get("date")
    else:
        commit, date = re.match(r"# .*; commit (\S+), (\S+)\n|", text).groups()
    good = re.fullmatch(r"[0-9a-f]{7,40}", commit or "") and re.fullmatch(r"\d{4}-\d\d-\d\d",
                                                                          date or "")
    return (commit, date) if good else None


def picture(name, file):
    """A picture of a scene as the last run left it, of the study or of its largest case; None if it
    left none."""
    folder = paths.RESULTS / name
    if not (folder / "summary.json").exists():
        return None
    cases = json.loads((folder / "summary.json").read_text()).get("cases", {})
    places = [folder, *(
        folder / case for case in sorted(cases, key=lambda case: -(cases[case]["particles"] or 0)))]
    return next((place / file for place in places if (place / file).is_file()), None)


# ---- pages ----

def texts():
    """{page: its text}, from the tables in doc, the READMEs and the logs of the scenes."""
    found = json.loads((paths.PAGE / "results.json").read_text())
    pages = {paths.PAGE / "README.md": results.render(found), paths.PAGE
             / "results.csv": results.table(found), PAGE / "README.md": evidence.cost_page()}
    for name in sweeps():
        summary = json.loads((PAGE / f"{name}.json").read_text())
        pages[PAGE / f"{name}.md"] = cost_report.page(summary, f"{name}.png", f"{name}.csv")
    tables = {name: read_csv(PAGE / f"{name}.csv") for name in TOOLS}
    pages |= {PAGE / "effects.md": effects.page(tables["effects"], tables["solids"]),
              PAGE / "peers.md": peers.page(tables["peers"]),
              PAGE / "scaling.md": scaling.page(tables["scaling"], tables["peers"],
                                                [largest.line(read_csv(PAGE / "largest.csv"))]),
              PAGE / "ranks.md": ranks.page(tables["ranks"]),
              evidence.HARD / "README.md": hard_pages.hard_page(),
              paths.ROOT / "doc/src/evidence.rst": evidence.page(),
              paths.ROOT / "doc/src/gallery.rst": gallery.page(),
              paths.ROOT / "doc/src/refusals.csv": refusals.page(),
              paths.ROOT / "doc/src/presets.csv": presets.page()}
    pages |= quoted.pages()
    readme = paths.ROOT / "README.md"
    ran = {paths.EXAMPLES / name / "README.md": found["scenes"].get(name, {}).get("summary")
           for name in paths.examples()}
    pages |= {path: results.run_times(path.read_text(), path.parent.name, summary)
              for path, summary in ran.items() if summary}
    return pages | {readme: results.readme(readme.read_text(), found)}


def draw():
    """Their pictures."""
    results.draw(json.loads((paths.PAGE / "results.json").read_text()), paths.PAGE / "results.png")
    for name in sweeps():
        cost_report.draw(PAGE / f"{name}.png", json.loads((PAGE / f"{name}.json").read_text()),
                         read_csv(PAGE / f"{name}.csv"))
    evidence.draw_cost(PAGE / "cost.png")
    evidence.draw_readme(PAGE / "cost_readme.png")
    evidence.draw_named(PAGE / "named.png")
    effects.draw(PAGE / "effects.png", read_csv(PAGE / "effects.csv"))
    peers.draw(PAGE / "peers.png", read_csv(PAGE / "peers.csv"))
    ranks.draw(PAGE / "ranks.png", read_csv(PAGE / "ranks.csv"))
    scaling.draw(PAGE / "scaling.png", read_csv(PAGE / "scaling.csv"))
    hard_pages.draw_hard(evidence.HARD / "hard.png")
    hard_pages.draw_readme(evidence.HARD / "hard_readme.png")


def main(arguments):
    """tools/renew"""
    only = arguments[1:] if arguments[:1] == ["--only"] else []
    if not only and (len(arguments) > 1 or any(word not in WORDS for word in arguments)):
        raise Refusal(f"'{' '.join(arguments)}' is not one of {', '.join(WORDS)}, --only SCENE or "
                      "cost/NAME ...")
    failed = [] if arguments else run()
    if only:
        take(only)
    elif "--pages-only" not in arguments:
        collect()
    draw()
    for path, text in texts().items():
        Path(path).write_text(text, encoding="utf-8")
    say(f"renew: {len(texts())} pages written")
    if typed := typed_numbers.report("HEAD"):
        say("renew: numbers that are typed by hand and have other data than in HEAD\n"
            + "\n".join(typed))
    if failed:
        print("renew: failed:", ", ".join(failed), file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    start("renew", main)
