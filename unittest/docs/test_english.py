"""User pages are plain American English without history; what is measured and tried is in data and
in doc/notes."""

import re

import pytest
from english import HOUSE, faults, length, sentences, words

from fsi import paths

ROOT = paths.ROOT
PAGES = [*(ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "CHANGELOG")),
         *(paths.folder(name) / "README.md" for name in paths.scenes()),
         *sorted((ROOT / "doc/src").glob("*.rst")),
         *(page for folder in (".", "cost", "hard", "results")
           for page in sorted((ROOT / "doc" / folder).glob("*.md")))]
NAMES = {page.relative_to(ROOT).as_posix(): page for page in PAGES}
COMMANDS = [page for page in PAGES if page.parent.name == "src"
            and page.stem.split("_")[0] in ("fix", "pair", "compute", "atom", "fsi")]
NOTES = sorted((ROOT / "doc/notes").glob("*.md"))


# Pages that programs write, and a few others, still have words of COMPRESSED: take a page out of
# here when it has none
WAITING = {"README.md", "doc/choosing.md", "doc/src/evidence.rst", "doc/src/fix_fsi_refine.rst",
           "doc/src/Howto_yield.rst", "unittest/hard/README.md",
           *(name for name in NAMES if name.startswith(("doc/cost/", "doc/hard/", "doc/results/")))}


@pytest.mark.parametrize("name", sorted(NAMES))
def test_page(name):
    text, markup = NAMES[name].read_text(encoding="utf-8"), NAMES[name].suffix[1:]
    assert not (faults(text, markup, HOUSE) if name in WAITING else faults(text, markup))


# ---- how much there is to read ----

def lengths(pages):
    return {page.relative_to(ROOT).as_posix(): length(page.read_text(encoding="utf-8"),
                                                      page.suffix[1:]) for page in pages}


def test_page_of_a_command_is_short():
    long = {name: count for name, count in lengths(COMMANDS).items() if count > 900}
    assert len(COMMANDS) > 20 and long == {}


def test_user_pages_can_be_read():
    """What grows on one page goes from another, into data, or into the notes. Tables of Markdown
    are data. The gallery repeats the first sentence of each scene's page."""
    counted = [page for page in PAGES
               if page not in (ROOT / "doc/src/gallery.rst", ROOT / "doc/results/README.md")]
    total = sum(length("\n".join(line for line in page.read_text(encoding="utf-8").splitlines()
                                 if not line.startswith("|")), page.suffix[1:]) for page in counted)
    print(f"{total} words on {len(counted)} user pages")
    assert total <= 33600


def test_notes_are_short():
    total = sum(lengths(NOTES).values())
    print(f"{total} words on {len(NOTES)} pages of notes")
    assert len(NOTES) > 5 and total <= 15000


def test_length():
    """Words and numbers, tables included; no code, formulas, or targets of links"""
    assert length("# A head\n\nOne `code here` two.\n\n```\nlmp -in a\n```\n\n"
                  "| a | 3 % |\n|---|---|\n| [b](c/d.md) | - |\n") == 8
    assert length("Head\n====\n\nOne :math:`x + y` and :doc:`two <three>`.\n\n.. math::\n\n"
                  "   x = y\n\n.. code-block:: LAMMPS\n\n   run 1\n", "rst") == 5


@pytest.mark.parametrize("name", paths.scenes())
def test_page_of_a_scene_has_the_template(name):
    assert not strays((paths.folder(name) / "README.md").read_text(encoding="utf-8"))


def strays(text):
    """[what differs from the template of a scene's page], doc/scenes.md"""
    lines, parts = text.splitlines(), re.findall(r"^## (.*)", text, re.M)
    said = [] if len(lines) <= 60 else [f"{len(lines)} lines"]
    if parts != ["Run", "Results", "Deviations", "References"]:
        said.append(f"sections {parts}")
    aim = lines[2] if len(lines) > 2 else ""
    if not (text.startswith("# ") and lines[1] == "" and aim.endswith(".") and lines[3] == ""
            and len(words(aim)) <= 25 and len(sentences(aim)) == 1):
        said.append("no title and aim of one sentence")
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    if len(pictures) > 2 or len(set(pictures)) < len(pictures):
        said.append(f"pictures {pictures}")
    deviations = text.partition("## Deviations")[2].partition("\n## ")[0]
    if not 1 <= len(sentences(deviations)) <= 3:
        said.append(f"{len(sentences(deviations))} sentences of deviations")
    if "|---|" not in text.partition("## Results")[2].partition("\n## ")[0]:
        said.append("no table of results")
    return said


def test_template_is_asked_for():
    good = ("# A\n\nIt falls.\n\n![a](a.png)\n\n## Run\n\n## Results\n|a|\n|---|\n\n## Deviations\n"
            "None is known.\n\n## References\nNone.\n")
    assert strays(good) == []
    for old, new in (("## Run\n", ""), ("It falls.", "It falls. It rests."),
                     ("![a](a.png)", "![a](a.png) ![a](a.png)"), ("|---|", ""),
                     ("None is known.", "One. Two. Three. Four."), ("None.", "\n" * 60)):
        assert strays(good.replace(old, new)) != [], (old, new)


def test_good_page_passes():
    assert not faults("# Beam\n\nA beam swings. Its period is within 0.9 % of finite elements.\n\n"
                      "| thickness | error |\n|---|---|\n| 3 | 0.9 % |\n\n"
                      "```\ntools/run beam   # some seconds\n```\n\n## References\n"
                      "Gray, J. P., Comput. Methods Appl. Mech. Engrg. 190 (2001) 6641.\n")
    assert not faults("Beam\n====\n\n.. index:: beam\n\n"
                      "A beam swings with :math:`\\omega` (:doc:`theory <theory>`, ``color``).\n\n"
                      ".. code-block:: LAMMPS\n\n   fix 1 all fsi/watch 10\n\n"
                      "The fluid's force acts across the interface.\n", "rst")


@pytest.mark.parametrize("text, said", [
    ("The plate was softer in 96a9f72.", "hash"), ("It rests (\\*).", "mark"),
    ("It rests (*).", "mark"), ("x" * 161, "161 characters"),
    ("A plate with 3 across swings.", "thickness"),
    ("Three particles\nacross a plate.", "thickness"), ("| 5 across |\n|---|\n| 3 |", "thickness"),
    ("It bears 0.7.", "stable"), ("Runs beside each other.", "next to"),
    ("None but for one.", "except"), ("The energy ledger closes.", "balance"),
    ("A watch stops it.", "monitor"), ("The source paper says so.", "its name"),
    ("Measured, one run each.", "history"),
    ("Neighbours have a colour.", "American"), ("Modelled in metres.", "American"),
    ("## Behaviour", "American"), ("It is normalised.", "American"),
    ("A word " + "and a word " * 15 + "ends.", "a sentence of 48"),
    ("One two " + "and three four " * 7 + "end.", "a mean sentence of 24.0"),
    ("- An item " + "and a word " * 15 + "goes on\n  and on.", "a sentence of"),
    ("The kernel is that\nof fix fsi.", "genitive"), ("Its faces and those of walls.", "genitive"),
    ("Solids have images, too.", "also"),
    ("The file is written anew.", "again"), ("*shift* does not go with *spacing*.", "combined"),
    ("Oil that comes around is slowed.", "re-enters"),
    ("It has a lattice of its own.", "separate"), ("In some 140 sub-steps.", "about"),
    ("The drag is 10 % off.", "an error of"),
    ("The gate is struck.", "hit"), ("Merging takes energy.", "what happens"),
    ("Read the deck.", "input script"),
    ("The article's scheme is older.", "original"),
    ("What is not named adds nothing.", "optional")])
def test_bad_page_fails(text, said):
    assert any(said in fault for fault in faults(text))
    if not text.startswith(("|", "##")):
        assert any(said in fault for fault in faults(text, "rst"))


def test_numbers_and_code_are_no_faults():
    assert not faults("It is 1e-10, 20240101 and 0.00083333; `5_across` and `beside` are names. "
                      "See [a page](beside.md).")
    assert not faults("Use *fix fsi/watch* or fix fsi/watch, besides others.", "rst")
    assert not faults("So that often happens; too many hit it. It has neighbors of its own body. "
                      "Some cases take long, and some do not.")
    assert not faults(".. list-table::\n\n   * - " + "x" * 200 + "\n", "rst")
    assert not faults("=====  =====\na      " + "b " * 90 + "\n=====  =====\n", "rst")


def test_sentences():
    assert sentences("# Head\n\nOne sentence, e.g. this. Another (in 3D).\n\n- an item\n- two\n\n"
                     "|a|b|\n") == ["One sentence, e.g. this.", "Another (in 3D).", "an item",
                                    "two"]
    assert sentences("Head\n====\n\nOne. Two\nlines.\n\n.. note::\n\n   Three.\n\n.. math::\n\n"
                     "   x = y\n\n* four\n", "rst") == ["One.", "Two lines.", "Three.", "four"]
