"""The structure of the sources: files include each other without a circle, fix fsi no style, laws nothing of LAMMPS; functions fit on a page."""

import re

import pytest

from fsi import paths

SOURCES = paths.ROOT / "src" / "FSI"
LAWS = ["contact", "density_diffusion", "elastic", "gradient", "hourglass", "jaumann", "kernel", "lattice", "pack", "plasticity", "shift", "stress_artificial",
        "tensor", "viscoelastic", "viscosity_artificial", "viscosity_laminar"]


def includes(name):
    """Our own files that NAME.h and NAME.cpp include."""
    texts = [(SOURCES / f"{name}{end}").read_text() for end in (".h", ".cpp") if (SOURCES / f"{name}{end}").exists()]
    found = {m for text in texts for m in re.findall(r'#include "(\w+)\.h"', text)}
    return {m for m in found if m != name and (SOURCES / f"{m}.h").exists()}


def graph():
    return {name: includes(name) for name in {p.stem for p in SOURCES.glob("*.*")}}


def circle(edges):
    """A list of files that begins and ends with the same one, or nothing."""
    done = set()

    def walk(name, path):
        if name in path:
            return [*path[path.index(name):], name]
        if name in done:
            return []
        for other in sorted(edges.get(name, ())):
            found = walk(other, [*path, name])
            if found:
                return found
        done.add(name)
        return []

    return next((found for name in sorted(edges) if (found := walk(name, []))), [])


def test_no_circle():
    edges = graph()
    assert len(edges) > 50  # it has read them
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]  # it would see one
    assert circle(edges) == []


def test_fix_fsi_knows_no_style():
    assert [name for name in includes("fix_fsi") if re.match(r"(fix|pair|compute)_", name)] == []
    assert len((SOURCES / "fix_fsi.cpp").read_text().splitlines()) < 450


def long_functions(text, most):
    """First lines of bodies of more lines than that: what stands between braces in the first column."""
    begin, found = None, []
    for number, line in enumerate(text.splitlines(), 1):
        if line == "{":
            begin = number
        elif line == "}" and begin:
            found += [begin] if number - begin - 1 > most else []
            begin = None
    return found


def test_functions_fit_on_a_page():
    assert long_functions("{\n" + "\n" * 91 + "}\n", 90) == [1]
    assert {file.name: found for file in SOURCES.glob("*.cpp") if (found := long_functions(file.read_text(), 90))} == {}


@pytest.mark.parametrize("law", LAWS)
def test_laws_are_without_lammps(law):
    """A law could be compiled for a device: it includes other laws and the C++ library alone."""
    allowed = {f"fsi_{name}.h" for name in LAWS} | {"math_eigen.h"}  # of a matrix, templates without the rest of LAMMPS
    assert set(re.findall(r'#include "([^"]+)"', (SOURCES / f"fsi_{law}.h").read_text())) <= allowed
