"""The table of mutation.py stays current: what it changes is in the sources. Running it takes minutes per entry."""

import mutation

from fsi import paths


def test_every_entry_is_in_the_sources():
    def stale(name, old, new, tests):
        here = (paths.ROOT / "src" / "FSI" / name).read_text()
        files = [list((paths.ROOT / "unittest").glob(f"*/test_{test}.py")) for test in tests.split() if test != "ctest"]
        return old not in here or old == new or not all(files)

    assert [entry for entry in mutation.MUTATIONS if stale(*entry)] == []
