"""Where the parts of the repository are."""

import os
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("FSI_BUILD_DIR") or ROOT / "build").resolve()
EXAMPLES = ROOT / "examples"
POTENTIALS = ROOT / "potentials"
RESULTS = ROOT / "results"
PAGE = ROOT / "doc" / "results"


def scenes():
    """Names of the bundled scenes, sorted."""
    return sorted(f.name for f in EXAMPLES.iterdir() if (f / f"in.{f.name}").is_file())


def lammps_source():
    """The LAMMPS tree that the build was configured with."""
    cache = BUILD / "CMakeCache.txt"
    for line in cache.read_text().splitlines():
        if line.startswith("LAMMPS_SOURCE_DIR:"):
            return Path(line.split("=", 1)[1])
    raise LookupError(f"{cache} does not name LAMMPS_SOURCE_DIR")
