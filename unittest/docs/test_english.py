"""User pages are plain American English without history; what is measured and tried is in data and in doc/notes."""

import pytest
from english import faults, sentences

from fsi import paths

ROOT = paths.ROOT
PAGES = [ROOT / "README.md", *sorted(paths.EXAMPLES.glob("*/README.md")), *sorted((ROOT / "doc").glob("*.md")), *sorted((ROOT / "doc/src").glob("*.rst")),
         *(page for folder in ("cost", "hard", "results") for page in sorted((ROOT / "doc" / folder).glob("*.md")))]
NAMES = {page.relative_to(ROOT).as_posix(): page for page in PAGES}
# Pages that are still to be written anew. A page that passes has to leave the list; nothing is added to it.
NOT_YET = frozenset(())


@pytest.mark.parametrize("name", sorted(set(NAMES) - NOT_YET))
def test_page(name):
    assert not faults(NAMES[name].read_text(encoding="utf-8"), NAMES[name].suffix[1:])


@pytest.mark.parametrize("name", sorted(NOT_YET))
def test_list_only_shrinks(name):
    assert name in NAMES, "the page is gone: take it from the list"
    assert faults(NAMES[name].read_text(encoding="utf-8"), NAMES[name].suffix[1:]), "the page passes: take it from the list"


def test_good_page_passes():
    assert not faults("# Beam\n\nA beam swings. Its period is within 0.9 % of finite elements.\n\n| thickness | error |\n|---|---|\n| 3 | 0.9 % |\n\n"
                      "```\ntools/run beam   # some seconds\n```\n\n## References\nGray, J. P., Comput. Methods Appl. Mech. Engrg. 190 (2001) 6641.\n")
    assert not faults("Beam\n====\n\n.. index:: beam\n\nA beam swings with :math:`\\omega` (:doc:`theory <theory>`, ``color``).\n\n"
                      ".. code-block:: LAMMPS\n\n   fix 1 all fsi/watch 10\n\nThe force across the interface is that of the fluid.\n", "rst")


@pytest.mark.parametrize("text, said", [
    ("The plate was softer in 96a9f72.", "hash"), ("It rests (\\*).", "mark"), ("It rests (*).", "mark"), ("x" * 161, "161 characters"),
    ("A plate with 3 across swings.", "thickness"), ("Three particles\nacross a plate.", "thickness"), ("| 5 across |\n|---|\n| 3 |", "thickness"),
    ("It bears 0.7.", "stable"), ("Runs beside each other.", "next to"), ("None but for one.", "except"), ("The energy ledger closes.", "balance"),
    ("A watch stops it.", "monitor"), ("The source paper says so.", "its name"), ("Measured, one run each.", "history"),
    ("Neighbours have a colour.", "American"), ("Modelled in metres.", "American"), ("## Behaviour", "American"), ("It is normalised.", "American"),
    ("A word " + "and a word " * 15 + "ends.", "a sentence of 47"), ("One two " + "and three four " * 7 + "end.", "a mean sentence of 24.0"),
    ("- An item " + "and a word " * 15 + "goes on\n  and on.", "a sentence of")])
def test_bad_page_fails(text, said):
    assert any(said in fault for fault in faults(text))
    if not text.startswith(("|", "##")):
        assert any(said in fault for fault in faults(text, "rst"))


def test_numbers_and_code_are_no_faults():
    assert not faults("It is 1e-10, 20240101 and 0.00083333; `5_across` and `beside` are names. See [a page](beside.md).")
    assert not faults("Use *fix fsi/watch* or fix fsi/watch, besides others.", "rst")
    assert not faults(".. list-table::\n\n   * - " + "x" * 200 + "\n", "rst")
    assert not faults("=====  =====\na      " + "b " * 90 + "\n=====  =====\n", "rst")


def test_sentences():
    assert sentences("# Head\n\nOne sentence, e.g. this. Another (in 3D).\n\n- an item\n- two\n\n|a|b|\n") == ["One sentence, e.g. this.", "Another (in 3D).", "an item", "two"]
    assert sentences("Head\n====\n\nOne. Two\nlines.\n\n.. note::\n\n   Three.\n\n.. math::\n\n   x = y\n\n* four\n", "rst") == ["One.", "Two lines.", "Three.", "four"]
