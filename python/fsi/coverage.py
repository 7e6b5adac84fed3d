"""Line coverage of src/FSI by the tests, from gcov. The command line of tools/coverage."""

import gzip
import json
import subprocess
import sys
import tempfile
from collections import defaultdict
from pathlib import Path

from . import paths, suite

BOUND = 90.0  # per cent


def collect():
    """{file name: {line: executed?}} over all objects; a line of a header counts if any object
    executed it."""
    covered = defaultdict(lambda: defaultdict(bool))
    objects = [p for p in paths.BUILD.rglob("*.gcda") if "FSI" in p.parts or "fsi" in p.name]
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["gcov", "--json-format", *map(str, objects)], cwd=folder, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for report in Path(folder).glob("*.gcov.json.gz"):
            for source in json.loads(gzip.decompress(report.read_bytes()))["files"]:
                # the compiler cache makes paths relative
                path = (paths.BUILD / source["file"]).resolve()
                if path.parent in paths.PACKAGES:
                    for line in source["lines"]:
                        covered[path.name][line["line_number"]] |= line["count"] > 0
    return covered


def main(arguments):
    """Runs pytest with `arguments` on an instrumented build and prints coverage per file; 0 if
    above the bound."""
    for path in paths.BUILD.rglob("*.gcda"):
        path.unlink()
    results = [suite.googletest(), suite.pytest(arguments)]
    covered = collect()
    total = hit = 0
    for name, lines in sorted(covered.items()):
        missed = sorted(n for n, executed in lines.items() if not executed)
        total += len(lines)
        hit += len(lines) - len(missed)
        print(f"{name:32s} {100 * (1 - len(missed) / len(lines)):6.1f} %  not executed: "
              f"{missed[:12] or '-'}")
    share = 100.0 * hit / total if total else 0.0
    print(f"line coverage of src/FSI: {share:.1f} % of {total} lines")
    return 0 if share > BOUND and not any(failed for _, failed in results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
