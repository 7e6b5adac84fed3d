"""The places that mutation.py changes are those of operators, signs and constants, in all numerics.
Running it takes minutes per place."""

import mutation

from fsi import paths

TEXT = """#include <a-b.h>   // 1.0 + 2.0
template <int D> Pair *f(const std::vector<double> &&p, double *q) { /* a * b */ for (int i = -1; i < 2; i++) return -x[i - 1]->y * 2.0e-3; }
if (a < b && c != d && e == "1.0 - 2.0") i++, s += 1 / (0.0 - *q);
static_assert(N > 2.0);
text += "none";
"""


def test_places():
    found = mutation.changes("a.h", TEXT)
    assert [(TEXT[c.start:c.end], c.new) for c in found] == [
        ("-", ""), ("*", "/"), ("2.0e-3", "0.003"), ("<", ">"), ("&&", "||"), ("!=", "=="),
        ("&&", "||"), ("+=", "-="), ("/", "*"), ("0.0", "1.0"), ("-", "+")]
    assert found[1].apply(TEXT) == TEXT.replace("->y * 2", "->y / 2")


def test_files_with_numerics_have_their_tests():
    files = [p.name for p in paths.sources().values() if p.suffix in (".cpp", ".h")]
    assert all(any(mutation.fnmatch(file, pattern) for file in files) for pattern in mutation.TESTS)
    names = {name for tests in mutation.TESTS.values() for name in tests.split()} - {"ctest"}
    assert [name for name in names
            if not list((paths.ROOT / "unittest").glob(f"*/test_{name}.py"))] == []
    # what is not listed reads input, writes output or advises
    assert len(mutation.all_changes()) > 0.85 * len(mutation.all_changes(files)) > 2000
