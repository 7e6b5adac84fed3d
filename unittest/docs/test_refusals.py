"""What does not go together is one table in the sources, and the manual's page is made of it."""

import re
import sys

from fsi import paths

sys.path.insert(0, str(paths.ROOT / "bench"))
import presets  # noqa: E402
import refusals  # noqa: E402

BY_LAMMPS = {"RESET_IDS"}  # LAMMPS refuses these itself


def test_the_page_is_that_of_the_table():
    assert ((paths.ROOT / "doc/src/refusals.csv").read_text()
            == refusals.page()), "tools/renew --pages-only writes it"


def test_the_page_of_presets_is_that_of_the_table():
    assert len(presets.table()) == presets.TABLE.read_text().count("},")
    assert ((paths.ROOT / "doc/src/presets.csv").read_text()
            == presets.page()), "tools/renew --pages-only writes it"


def test_every_row_is_used_and_every_use_has_a_row():
    used = {name for file in paths.sources("*.cpp").values()
            for name in re.findall(r"Refused::([A-Z_0-9]+)", file.read_text())}
    rows = {name for _, name, *_ in refusals.table()}
    assert len(rows) > 40 and rows - used == BY_LAMMPS and used <= rows


def test_the_table_is_read_whole():
    text = refusals.TABLE.read_text()
    assert len(refusals.table()) == len(re.findall(r"\{(?:REQUIRES|NOT_WITH),", text))
