"""Parts of decks on pages of the manual, which a git host shows as they are: a comment says what
stands in the block of code below it.

    .. deck in.howto: variable to atom_style

    .. code-block:: LAMMPS

From the first line that begins with `variable` to the next that begins with `atom_style`; without
the latter to the end of the paragraph.
"""

import re

from . import paths
from .command import Refusal

MARK = re.compile(r"^(\.\. deck (\S+): (.+?)(?: to (.+))?\n\n)(?:\.\. code-block:: LAMMPS\n\n(?:   "
                  r".*\n|\n(?=   |\n))*\n?)?", re.M)
PAGES = ("Howto_fsi", "tutorial_flap", "tutorial_gate", "tutorial_own_body")


def part(deck, start, end=None):
    """Lines of a deck as a mark names them."""
    lines = deck.splitlines()
    try:
        first = next(k for k, line in enumerate(lines) if line.startswith(start))
        last = next(k for k, line in enumerate([*lines[first + 1:], ""], start=first)
                    if (line.strip() == "" if end is None else line.startswith(end)))
    except StopIteration:
        raise Refusal(f"a page quotes a deck from '{start}' to "
                      f"'{end or 'the end of the paragraph'}', which it does not have") from None
    return lines[first:last + (end is not None) + 1]


def renewed(text, folder):
    """The text of a page in `folder` with its blocks made anew."""
    def block(match):
        lines = part((folder / match[2]).read_text(encoding="utf-8"), match[3], match[4])
        return match[1] + ".. code-block:: LAMMPS\n\n" + "\n".join(f"   {line}" if line else ""
                                                                   for line in lines) + "\n\n"
    return MARK.sub(block, text)


def pages():
    """{page: its text}"""
    folder = paths.ROOT / "doc/src"
    return {folder / f"{name}.rst": renewed((folder / f"{name}.rst").read_text(encoding="utf-8"),
                                            folder) for name in PAGES}
