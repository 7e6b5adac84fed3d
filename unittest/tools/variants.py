#!/usr/bin/env python3
"""Builds LAMMPS with the package in other ways and runs small scenes with each: results must be
those of the normal build.

usage: variants.py [NAME ...]     (default: all but newest, which downloads LAMMPS)
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

from fsi import dump, launch, paths  # noqa: E402

sys.path[:0] = [str(ROOT / "unittest"), *launch.environment()["PYTHONPATH"].split(os.pathsep)]

from pairs.factors import allowed, simple  # noqa: E402
from pairs.scene import PairScene, go_on_ranks, read  # noqa: E402
from pairs.test_pairs import ROUND, same as same_state  # noqa: E402
from scenes import dam_gate, difference, fluid_box, run, watch  # noqa: E402

# name: options of cmake, ranks that it can run on
NEWEST = {"newest": ("-DFSI_LAMMPS_RELEASE=20260704", (1, 2))}
VARIANTS = {
    # LAMMPS is compiled once more: with few styles, not optimized
    "bigbig-serial": ("-DLAMMPS_SIZES=bigbig -DBUILD_MPI=OFF -DPKG_GRANULAR=OFF -DPKG_GRAPHICS=OFF "
                      "-DPKG_OPENMP=OFF -DCMAKE_CXX_FLAGS_RELEASE=-O0", (1,)),
    "sanitized": ("-DFSI_SANITIZE=address,undefined", (1, 2)),
}
# other compilers, which only look at the sources, with LAMMPS' MPI for one process: those that are
# installed
COMPILERS = {
    "clang": ("clang++", "-std=c++20"),
    "arm": ("aarch64-linux-gnu-g++", "-std=c++17"),
}
SCENES = {
    "dam 2D": dam_gate(2, solid="artificial/visc 0.1 0 artificial/stress 0.3 gradient corrected"),
    "dam 3D": dam_gate(3, fluid="sound 10 couple full artificial/visc 0.05 0",
                       solid="artificial/visc 0.1 0"),
    "quadratic": dam_gate(3,
                          solid="artificial/visc 0.1 0 artificial/stress 0.2 gradient quadratic"),
    "fluid 2D": fluid_box(2),
    "ratio": dam_gate(2, density="fluid summation solid ratio",
                      fluid="sound 10 artificial/visc 0.05 0 surface 0.9"),
}
# what keeps atom IDs, local indices or images between events: levels of unittest/pairs
PAIRS = {
    "plane of symmetry": ("symmetry plane", "svk", "laminar", "write_restart"),
    "levels, renumbered": ("region", "background", "shift", "delete_atoms"),
    "levels around a body": ("distance", "volumetric", "mirrors", "delete, no compress"),
    "open ends": ("two pressures", "tension", "central", "delete_atoms"),
    "clamp on a float": ("clamp on a float", "sub-steps", "neo-hookean", "gravity"),
    "grains": ("grains", "contact", "plastic", "mirrors"),
}
assert all(allowed(levels) for levels in PAIRS.values())
# what builds of their own need of LAMMPS' styles, for the scenes here and for unittest/kokkos
STYLES = """compute_ke compute_pe compute_pressure compute_reduce compute_temp dump_custom fix_addforce fix_balance fix_gravity fix_nh fix_nve
    fix_property_atom fix_setforce pair_hybrid pair_hybrid_overlay pair_zero region_block""".split()
SOURCES = [path for package in ("FSI", "FSI-CLASSIC", "OPENMP", "KOKKOS")
           for path in sorted((ROOT / "src" / package).iterdir())
           if path.suffix in (".h", ".cpp")]
ROUND_OFF = 1e-11  # 40 steps with sums in another order, as in test_restart.py
TAIL = """compute energy all fsi/energy
compute surface all fsi/surface/atom
compute psi all fsi/atom psi vonmises
thermo_style custom step c_energy
dump extra all custom 40 extra.dump id c_surface c_psi[1] c_psi[2]
restart 20 old.*
run 40
write_data end.data
"""


def with_few_styles(source, folder):
    """A tree of links to LAMMPS' sources without styles that none of the scenes needs, which are
    half of all files; returns it."""
    src = source / "src"
    style = re.compile("(angle|bond|compute|dihedral|dump|fix|improper|kspace|pair|region)_")
    left = {path.name for path in src.glob("*.cpp") if not style.match(path.name)
            or path.stem in STYLES}
    todo = list(left)
    while todo:    # and what these include
        name = todo.pop()
        for path in (src / name, (src / name).with_suffix(".h")):
            headers = re.findall(r'#include "(\w+)\.h"',
                                 path.read_text(errors="replace")) if path.exists() else ()
            more = {f"{header}.cpp" for header in headers
                    if (src / f"{header}.cpp").exists()} - left
            left |= more
            todo += more
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "src").mkdir(parents=True)
    for path in source.iterdir():
        if path != src:
            (folder / path.name).symlink_to(path)
    for path in src.iterdir():
        if not style.match(path.name) or f"{path.stem}.cpp" in left:
            (folder / "src" / path.name).symlink_to(path)
    return folder


def run_scenes(folder, ranks):
    """Runs every scene with the build that FSI_BUILD_DIR names."""
    for name, scene in SCENES.items():
        run(Path(folder) / name, scene.text() + watch(every=40) + TAIL, int(ranks),
            scene_data=scene.data())
    for name, levels in PAIRS.items():
        go_on_ranks(PairScene(simple(levels)), Path(folder) / name, int(ranks))


def produce(folder, build, ranks):
    """The same in a process of its own, since the build folder is chosen when the module is
    loaded."""
    # Open MPI leaks
    environment = {**os.environ, "FSI_BUILD_DIR": str(build), "ASAN_OPTIONS": "detect_leaks=0"}
    code = f"import variants; variants.run_scenes({str(folder)!r}, {ranks})"
    return subprocess.run([sys.executable, "-c", code], cwd=ROOT / "unittest" / "tools",
                          env=environment, check=False).returncode == 0


def same(a, b):
    """Do all scenes of two folders end in the same state?"""
    for name in SCENES:
        p, q = (dump.read(Path(f) / name / "atoms.dump")[-1] for f in (a, b))
        for quantity in ("x", "v", "rho", "stress"):
            if name == "fluid 2D" and quantity == "stress":
                continue
            if not difference(p, q, quantity) < ROUND_OFF:
                print(f"{name}: {quantity} differs by {difference(p, q, quantity):.1e}")
                return False
    for name, levels in PAIRS.items():
        try:
            same_state(PairScene(simple(levels)), *(read(Path(f) / name) for f in (a, b)), ROUND)
        except AssertionError as error:
            print(f"{name}: {error}")
            return False
    return True


def memcheck(folder, build):
    """valgrind on a few steps of the first scene and of those of pairs, without MPI, whose memory
    is its own affair."""
    name, scene = next(iter(SCENES.items()))
    decks = {name: (scene.text() + watch(every=3) + TAIL.replace("40", "3").replace("20", "2"),
                    scene.data())}
    for name, levels in PAIRS.items():
        scene = PairScene(simple(levels))
        decks[name] = (re.sub(r"^run 1\d$", "run 4", scene.text("."), flags=re.M), scene.data())
    environment = {**launch.environment(), "LD_LIBRARY_PATH": str(build)}

    def faults(name):
        text, data = decks[name]
        place = Path(folder) / "valgrind" / name
        place.mkdir(parents=True)
        (place / "scene.data").write_text(data)
        (place / "in.test").write_text(text)
        done = subprocess.run(["valgrind", "-q", "--error-exitcode=9", str(build / "lmp"), "-in",
                               "in.test"], cwd=place,
                              env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False)
        return done.stdout.splitlines()[-30:] if done.returncode else []

    return side_by_side(faults, decks)


def side_by_side(faults, names):
    """Prints what faults(name) finds, as many at once as there are cores; is there nothing?"""
    with ThreadPoolExecutor(launch.cores()) as pool:
        found = dict(zip(names, pool.map(faults, names)))
    for name, lines in found.items():
        if lines:
            print(f"{name}:", *lines, sep="\n", flush=True)
    return not any(found.values())


def understood(compiler, standard):
    """Has a compiler neither an error nor a warning for any source?"""
    tree = paths.lammps_source() / "src"

    def faults(source):
        done = subprocess.run([compiler, standard, "-fsyntax-only", "-Wall", "-Werror",
                               "-DLAMMPS_SMALLBIG", *(f"-I{package}" for package in paths.PACKAGES),
                               *(f"-isystem{tree / part}" for part in ("", "RIGID", "STUBS")),
                               str(source)],
                              capture_output=True, text=True, check=False)
        return [line for line in done.stderr.splitlines()
                if "error" in line][:9] or ["fails"] if done.returncode else []

    return side_by_side(faults, list(paths.sources("*.cpp").values()))


def formatted():
    """Are the sources as clang-format writes them?"""
    return subprocess.run(["clang-format", f"--style=file:{ROOT / 'src/FSI/.clang-format'}",
                           "--dry-run", "-Werror",
                           *map(str, SOURCES)], check=False).returncode == 0


def main(names):
    """Returns (passed, failed)."""
    results = {}
    normal = Path(os.environ.get("FSI_BUILD_DIR") or ROOT / "build")
    with tempfile.TemporaryDirectory() as scratch:
        produce(Path(scratch) / "normal", normal, 1)
        installed = [name
                     for name, words in {**COMPILERS, "clang-format": ("clang-format",)}.items()
                     if shutil.which(words[0])]
        for name in names or [*VARIANTS, *installed]:
            if name == "clang-format":
                results[f"{name}: all sources"] = formatted()
                continue
            if name in COMPILERS:
                results[f"{name}: all sources"] = understood(*COMPILERS[name])
                continue
            options, ranks = {**VARIANTS, **NEWEST}[name]
            build = Path(f"{normal}-{name}")
            environment = {**os.environ, "FSI_BUILD_DIR": str(build), "FSI_CMAKE_OPTIONS": options}
            if name in NEWEST:
                environment["LAMMPS_SOURCE_DIR"] = ""  # a tree named there would be taken
            if name == "bigbig-serial":
                environment["LAMMPS_SOURCE_DIR"] = str(
                    with_few_styles(paths.lammps_source(), build / "few-styles"))
            built = subprocess.run([str(ROOT / "tools" / "setup")], check=False, env=environment)
            results[f"{name}: builds"] = built.returncode == 0
            for n in ranks:
                folder = Path(scratch) / f"{name}-{n}"
                results[f"{name}: {n} rank{'s' * (n > 1)}, as the normal build"] = (
                    produce(folder, build, n) and same(Path(scratch) / "normal", folder))
            if name == "bigbig-serial":
                results[f"{name}: valgrind finds no error"] = memcheck(scratch, build)
    for what, good in results.items():
        print(f"{'passed' if good else 'FAILED'}  {what}", flush=True)
    return sum(results.values()), len(results) - sum(results.values())


if __name__ == "__main__":
    passed, failed = main(sys.argv[1:])
    sys.exit(1 if failed else 0)
