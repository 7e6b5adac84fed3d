"""Runs all tests and adds them up. The command line of tools/test.

GoogleTest for the mathematics, pytest for the rest, the same scenes under other builds, and line
coverage.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from xml.etree import ElementTree

from . import launch, paths

# What --quick and the line coverage leave out of unittest/, beside cases marked slow: scenes, whose
# equations the tests of the styles look at one by one; what runs tools, installs, builds or counts
# instructions, to which an instrumented build adds its own
SLOW = ["scenes", "pairs", "tools", "docs", "styles/test_fuzz.py", "styles/test_faults.py"]


def googletest():
    """(passed, failed) of the GoogleTest cases that the build registered with ctest; (0, 0) if it
    has none."""
    if not (paths.BUILD / "CTestTestfile.cmake").exists():
        return 0, 0
    command = ["ctest", "--test-dir", str(paths.BUILD), "--output-on-failure", "--progress", "-j",
               str(launch.cores())]
    lines = []
    with subprocess.Popen(command, env=launch.environment(), stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT,
                          text=True, errors="replace") as process:
        for line in process.stdout:
            lines.append(line)
            print(line, end="", flush=True)
    for line in lines:
        match = re.search(r"(\d+) tests? failed out of (\d+)", line)
        if match:
            failed, total = int(match[1]), int(match[2])
            return total - failed, failed
    return 0, int(process.returncode != 0)


def pytest(arguments):
    """(passed, failed) of the tests in unittest/; an error in collecting or setting up counts as a
    failure."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.xml"
        # tests side by side, since most run on one core; those that share what a fixture has run
        # stay together (unittest/conftest.py). Long ones first
        tests = [str(paths.ROOT / "unittest" / name)
                 for name in ("tools", "scenes", "docs", "pairs", "styles")]
        # pytest would collect what it is given, ignored or not
        tests = [test for test in tests if f"--ignore={test}" not in arguments]
        command = [sys.executable, "-m", "pytest", "-q", "-n", str(launch.cores()), "--dist",
                   "loadgroup", f"--junitxml={report}",
                   *arguments, *tests]
        status = subprocess.run(command, cwd=paths.ROOT, env=launch.environment(),
                                check=False).returncode
        return outcomes(report, status)


def outcomes(report, status):
    """(passed, failed) of a report of pytest, which ended with that status"""
    passed = failed = 0
    if report.exists():
        for case in ElementTree.parse(report).iter("testcase"):
            outcome = {child.tag for child in case}
            failed += bool(outcome & {"failure", "error"})
            passed += not outcome & {"failure", "error", "skipped"}
    # 5: nothing was collected; anything else without a failed test is a fault of the runner
    if status not in (0, 5) and failed == 0:
        failed = 1
    return passed, failed


def variants():
    """unittest/tools/variants.py"""
    sys.path.insert(0, str(paths.ROOT / "unittest" / "tools"))
    import variants as module
    return module


def other_builds():
    """(passed, failed) of the small scenes under other builds of LAMMPS."""
    return variants().main([])


def kokkos():
    """(passed, failed) of the styles with suffix kk, in a LAMMPS with package KOKKOS
    (tools/kokkos); (0, 0) where none can be made."""
    tool = str(paths.ROOT / "tools" / "kokkos")
    if subprocess.run([tool, "--possible"], check=False).returncode:
        return 0, 0
    # few styles, less optimized: compiling takes half the time, and the tests are short
    build = paths.ROOT / "build-kokkos-test"
    report = build / "report.xml"  # which that system sees
    report.unlink(missing_ok=True)
    lammps = subprocess.run([tool, "--lammps"], env={**os.environ, "LAMMPS_SOURCE_DIR": ""},
                            stdout=subprocess.PIPE, text=True, check=True).stdout.strip()
    options = {"FSI_KOKKOS_BUILD": str(build), "FSI_CMAKE_OPTIONS": "-DCMAKE_CXX_FLAGS_RELEASE=-O1",
               "LAMMPS_SOURCE_DIR": str(
                   variants().with_few_styles(Path(lammps), build / "few-styles"))}
    status = subprocess.run([tool, "--test", "-q", "-n", str(launch.cores()),
                             f"--junitxml={report}"], env={**os.environ, **options},
                            check=False).returncode
    return outcomes(report, status)


def quick():
    """pytest's options that leave the slow tests out."""
    return ["-m", "not slow", *(f"--ignore={paths.ROOT / 'unittest' / name}" for name in SLOW)]


def coverage():
    """(1, 0) if one case of each quick test passes, and these execute enough of src/FSI
    (tools/coverage)."""
    good = subprocess.run([str(paths.ROOT / "tools" / "coverage"), "--last-case", *quick()],
                          check=False).returncode == 0
    return int(good), int(not good)


def main(arguments):
    """Runs everything, or with --quick or pytest's options only GoogleTest and pytest; the last
    line is the sum."""
    if "--quick" in arguments:
        arguments = [*(a for a in arguments if a != "--quick"), *quick()]
    results = [googletest(), pytest(arguments)]
    if not arguments:
        results += [other_builds(), kokkos(), coverage()]
    passed, failed = (sum(column) for column in zip(*results))
    print(f"{passed} passed, {failed} failed", flush=True)
    return 0 if passed and not failed else 1


if __name__ == "__main__":
    os.chdir(paths.ROOT)
    sys.exit(main(sys.argv[1:]))
