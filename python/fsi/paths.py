"""Where the parts of the repository are."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("FSI_BUILD_DIR") or ROOT / "build").resolve()
EXAMPLES = ROOT / "examples"
DRIVERS = ROOT / "unittest"  # of tests: scenes that tools/run takes, too, and that nobody copies
PACKAGES = [ROOT / "src/FSI", ROOT / "src/FSI-CLASSIC", ROOT / "src/OPENMP"]
POTENTIALS = ROOT / "potentials"
RESULTS = ROOT / "results"
PAGE = ROOT / "doc" / "results"


def sources(pattern="*.*"):
    """Files of the packages, by name."""
    return {path.name: path for package in PACKAGES for path in sorted(package.glob(pattern))}


def examples():
    """Names of the scenes for users, sorted."""
    return sorted(path.parent.name for path in EXAMPLES.glob("*/in.*") if path.name
                  == f"in.{path.parent.name}")


def scenes():
    """Names of all that tools/run takes, sorted: scenes for users and drivers of tests."""
    drivers = [path.parent.name for path in DRIVERS.glob("*/in.*") if path.name
               == f"in.{path.parent.name}"]
    return sorted([*examples(), *drivers])


def folder(scene):
    """Where a scene is, or would be."""
    driver = DRIVERS / scene
    return driver if (driver / f"in.{scene}").is_file() else EXAMPLES / scene


def lammps_source():
    """The LAMMPS tree that the build was configured with."""
    cache = BUILD / "CMakeCache.txt"
    for line in cache.read_text().splitlines():
        if line.startswith("LAMMPS_SOURCE_DIR:"):
            return Path(line.split("=", 1)[1])
    raise LookupError(f"{cache} does not name LAMMPS_SOURCE_DIR")
