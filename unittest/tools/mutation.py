#!/usr/bin/env python3
"""Do the tests notice wrong numerics? Changes operators, signs and constants of src/FSI one by one
and runs the tests on each.

usage: mutation.py [--count N] [--seed N] [FILE ...]     (default: 20 places, chosen by seed 1
among all files below; count 0: all)

Places are found in the sources' tokens, so nothing here follows their text. Works on a copy of the
project in a temporary folder; a change that no test fails for has survived. Status 1 if more than a
fifth do: some changes alter no result that can be seen.
"""

import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = {path.name: path for package in ("FSI", "FSI-CLASSIC", "OPENMP")
           for path in (ROOT / "src" / package).iterdir()}

# files with numerics, by pattern (the first that fits): the tests that look at them, test_NAME.py,
# or ctest
TESTS = {
    "fsi_kernel.h": "ctest lattice", "fsi_tensor.h": "ctest", "fsi_walls.h": "ctest walls",
    "fsi_gradient.h": "ctest", "fsi_solid_laws.h": "ctest plasticity viscoelastic",
    "fsi_pack.h": "ctest",
    "fsi_classic_laws.h": "ctest solid solid_tl",
    "fsi_pair_laws.h": "ctest viscosity walls density shift contact self_contact",
    "fsi_material.*": "ctest density solid", "fsi_sight.cpp": "thin",
    "fsi_fluid_*":
        "density momentum walls surface interface viscosity wall_particles shift spacing",
    "fsi_rows_omp.h": "omp", "pair_fsi_*_omp.*": "omp",
    "fsi_pair_sets.*": "walls thin lists", "fsi_wet_solids.cpp": "walls solid_tl",
    "pair_fsi_fluid.cpp": "density integrator dt interface surface wall_particles shift",
    "pair_fsi_solid.*": "solid integrator energy momentum",
    "pair_fsi_solid_tl.*": "solid_tl energy report contact",
    "fsi_law_list.h": "solid_tl viscoelastic",
    "fsi_bond_rows.h": "solid_tl plasticity", "fix_fsi_reference.*": "solid_tl plasticity",
    "fsi_bond_*.cpp": "solid_tl plasticity", "fsi_damage.*": "solid_tl",
    "fsi_self_contact.*": "self_contact", "fsi_frame.cpp": "lists", "fsi_clamps.cpp": "clamp",
    "fsi_lammps_access.cpp": "clamp gravity", "fsi_images.h": "symmetry",
    "pair_fsi.cpp": "solid density solid_tl", "fix_fsi.cpp": "integrator density momentum restart",
    "fsi_motion.cpp": "integrator momentum",
    "fsi_number_density.*": "density surface parallel restart",
    "fsi_hub.cpp": "surface density energy gravity",
    "fsi_fields.cpp": "parallel restart solid_tl wall_particles",
    "fix_fsi_stress.*": "solid integrator plasticity restart viscoelastic",
    "fix_fsi_wall_mirror.cpp": "walls report", "fix_fsi_wall_particle.cpp": "wall_particles",
    "fix_fsi_dt.cpp": "dt", "fsi_limits.cpp": "dt watch", "fix_fsi_move.cpp": "move",
    "fix_fsi_stream.cpp": "stream",
    "fix_fsi_inlet.cpp": "inlet", "fsi_open_end.cpp": "inlet", "fsi_buffer.cpp": "inlet",
    "fix_fsi_refine.cpp": "refine", "fsi_refine.h": "refine", "fix_fsi_spectrum.cpp": "spectrum",
    "fix_fsi_watch.cpp": "watch", "fix_fsi_report.cpp": "report",
    "fsi_check.cpp": "stop", "fsi_pack_command.cpp": "packing",
    "fsi_commands.cpp": "displace density materials clamp_command",
    "compute_fsi_energy.cpp": "energy solid_tl", "compute_fsi_force.cpp": "force",
    "compute_fsi_probe.cpp": "probe", "compute_fsi_atom.cpp": "density solid surface",
    "fsi_volumetric.h": "solid_volumetric", "fsi_changes.*": "redefine",
    "fsi_keywords.*": "redefine move stream restart", "fsi_cells.h": "advice self_contact",
    "fsi_advice.cpp": "advice", "fsi_stop.cpp": "stop watch",
}
SWAPS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=",
         "<": ">", ">": "<", "<=": ">", ">=": "<", "==": "!=",
         "!=": "==", "&&": "||", "||": "&&"}
TOKEN = re.compile(r"""(?P<skip>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
                     |(?P<number>(?:\d+\.\d*|\.\d+|\d+(?=[eE]))(?:[eE][+-]?\d+)?)|(?P<word>\w+)
                     |(?P<operator><<|>>|->|\+\+|--|&&|\|\||[-+*/<>=!]=|[-+*/<>=!])|(?P<other>\S)""", re.M | re.S | re.X)


@dataclass(frozen=True)
class Change:
    """What is put between two positions of a file."""

    file: str
    start: int
    end: int
    new: str

    def apply(self, text):
        return text[:self.start] + self.new + text[self.end:]


def tests_of(file):
    """Tests that look at a file; None if it is not among those with numerics."""
    return next((tests for pattern, tests in TESTS.items() if fnmatch(file, pattern)), None)


def changes(file, text):
    """Every place in a text: operators between two operands, which the style puts between spaces;
    signs; floating-point constants.

    Not between [ and ] or in the head of a loop, where nearly any change ends in a crash, nor what
    the compiler checks, nor of strings.
    """
    found, before, checked, brackets = [], None, 0, 0
    for token in TOKEN.finditer(text):
        kind, word, (start, end) = token.lastgroup, token[0], token.span()
        if kind == "skip":
            continue
        if kind == "word" and word == "static_assert":
            checked = text.find(";", end)
        elif kind == "word" and word == "for":
            checked = min(i for i in (text.find(") ", end), text.find(")\n", end)) if i > 0)
        brackets += (word == "[") - (word == "]")
        if start >= checked and brackets == 0:
            operand = before and (before.lastgroup in ("number", "word")
                                  and before[0] not in ("return", "operator") or before[0] in ")]")
            if kind == "number":
                value = float(word)
                found.append(Change(file, start, end, repr(1.5 * value) if value else "1.0"))
            elif word in SWAPS and operand and text[start - 1].isspace() and re.match(
                r'\s+[^\s"]', text[end:]):
                found.append(Change(file, start, end, SWAPS[word]))
            elif word == "-" and not operand and text[end] not in " =":
                found.append(Change(file, start, end, ""))
        before = token
    return found


def all_changes(files=()):
    names = files or sorted(name for name in SOURCES if tests_of(name))
    return [change for name in names for change in changes(name, SOURCES[name].read_text())]


def run(command, folder, environment):
    return subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False,
                          timeout=900).returncode


def verdict(copy, environment, change):
    """Builds the copy with the change and runs its tests, those of the mathematics first."""
    source = copy / SOURCES[change.file].relative_to(ROOT)
    text = source.read_text()
    source.write_text(change.apply(text))
    try:
        if run(["tools/setup", "--tests"], copy, environment):
            return "no program"
        names = tests_of(change.file).split()
        if "ctest" in names and run(["ctest", "--test-dir", "build"], copy, environment):
            return "caught"
        files = [str(f.relative_to(copy)) for name in names if name != "ctest"
                 for f in copy.glob(f"unittest/*/test_{name}.py")]
        return "caught" if files and run(["tools/pytest", "-x", "-q", *files], copy,
                                         environment) else "SURVIVED"
    except subprocess.TimeoutExpired:
        return "caught"
    finally:
        source.write_text(text)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", metavar="FILE", nargs="*",
                        help="of src/FSI; default: all with numerics")
    parser.add_argument("--count", type=int, default=20, help="how many places; 0: all")
    parser.add_argument("--seed", type=int, default=1, help="which places")
    given = parser.parse_args(arguments)
    places = all_changes(given.files)
    if 0 < given.count < len(places):
        places = random.Random(given.seed).sample(places, given.count)
    verdicts = []
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "project"
        shutil.copytree(ROOT, copy, symlinks=True,
                        ignore=shutil.ignore_patterns("build*", "results", ".git"))
        environment = {**os.environ, "FSI_BUILD_DIR": str(copy / "build"),
                       "FSI_CMAKE_OPTIONS": "-DFSI_INSTRUMENT=-O0", "CCACHE_BASEDIR": str(copy)}
        if run(["tools/setup", "--tests"], copy, environment):
            sys.exit("the unchanged copy does not build")
        for change in places:
            text = SOURCES[change.file].read_text()
            line = text.count("\n", 0, change.start) + 1
            verdicts.append(verdict(copy, environment, change))
            print(f"{verdicts[-1]:10s} {change.file}:{line}: {text[change.start:change.end]} -> "
                  f"{change.new or 'nothing'}   {text.splitlines()[line - 1].strip()[:90]}",
                  flush=True)
    caught, survived = verdicts.count("caught"), verdicts.count("SURVIVED")
    print(f"{caught} of {caught + survived} caught; {verdicts.count('no program')} more do not "
          "compile")
    return 0 if survived <= 0.2 * len(verdicts) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
