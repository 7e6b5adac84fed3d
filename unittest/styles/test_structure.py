"""The structure of the sources: files include each other without a circle, fix fsi no style, laws
nothing of LAMMPS; functions fit on a page."""

import io
import re
import tokenize

import pytest

from fsi import paths

SOURCES = paths.sources()
LAWS = ["classic_laws", "gradient", "kernel", "pack", "pair_laws", "solid_laws", "tensor",
        "viscosity"]


def includes(name):
    """Our own files that NAME.h and NAME.cpp include."""
    texts = [SOURCES[f"{name}{end}"].read_text() for end in (".h", ".cpp")
             if f"{name}{end}" in SOURCES]
    found = {m for text in texts for m in re.findall(r'#include "(\w+)\.h"', text)}
    return {m for m in found if m != name and f"{m}.h" in SOURCES}


def graph():
    return {name: includes(name) for name in {p.stem for p in SOURCES.values()}}


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


def test_style_headers_are_bare():
    """LAMMPS' rule: the header of a style includes those of its base classes alone, each of which
    its class statement names."""
    names = {"fix": "Fix", "pair": "Pair", "compute": "Compute", "command": "Command",
             "atom_vec": "AtomVec", "fsi_part": "FSI::Part",
             "pair_fsi": "PairFSI", "pair_fsi_fluid": "PairFSIFluid",
             "pair_fsi_solid_tl": "PairFSISolidTL", "fsi_fields": "FSI::FixFields",
             "fsi_bond_store": "FSI::BondStore"}
    styles, more = 0, {}
    for file in paths.sources("*.h").values():
        text = file.read_text()
        if not re.search(r"^(Fix|Pair|Compute|Atom|Command)Style\(", text, re.M):
            continue
        styles += 1
        bases = set(re.search(r"^class \w+ : ([^{]*)\{", text, re.M)[1].replace(
            "virtual", "").replace("public", "").replace(" ", "").strip().split(","))
        more[file.name] = {h for h in re.findall(r'#include "(\w+)\.h"', text)
                           if names.get(h) not in bases}
    assert styles > 20 and {name: found for name, found in more.items() if found} == {}


def test_fix_fsi_knows_no_style():
    assert [name for name in includes("fix_fsi") if re.match(r"(fix|pair|compute)_", name)] == []
    assert len(SOURCES["fix_fsi.cpp"].read_text().splitlines()) < 450


def test_no_style_keeps_fix_fsi():
    """Styles and parts of a step take objects from fix fsi when a run begins: none keeps the fix,
    to call it back in a step."""
    headers = [file for file in SOURCES.values() if file.suffix == ".h" and file.name
               != "fix_fsi.h"]
    assert len(headers) > 70 and [file.name for file in headers
                                  if re.search(r"\bFixFSI\b", file.read_text())] == []


def test_other_packages_are_apart():
    """FSI is built without them."""
    others = {path.stem for path in SOURCES.values()
              if path.parent.name in ("FSI-CLASSIC", "OPENMP")}
    assert {"pair_fsi_solid", "pair_fsi_fluid_omp"} <= others
    assert [path.stem for path in SOURCES.values() if path.parent.name == "FSI"
            and includes(path.stem) & others] == []


def test_styles_are_found_by_what_they_are():
    """A suffix changes the name of a style: fsi_find.h looks at classes."""
    named = re.compile(r'(?:pair_match|get_\w+_by_style)\("[^"]*fsi[^"]*"|strmatch\([^)]*fsi/\w')
    assert named.search('force->pair_match("fsi/fluid", 1)') and named.search(
        'get_fix_by_style("^fsi/dt$")')
    found = {p.name: named.findall(p.read_text()) for p in SOURCES.values()}
    assert {name: f for name, f in found.items() if f and (name, f)
            != ("fsi_find.h", ['pair_match("^fsi/"'])} == {}


def test_protected_members_are_read_in_one_file():
    """What LAMMPS shows to derived classes only is read by fsi_lammps_access.cpp alone: nothing
    else derives from a class of LAMMPS and names its members by address."""
    peeks = re.compile(r"\b(?:struct|class) (\w+) (?:final )?: (?:public "
                       r")?(Modify|CommBrick|Comm|Fix\w*|Neighbor|Domain|Atom|Force)\b[^{;]*\{[^}]*"
                       r"(?:&\1::|using \2::)")
    assert peeks.search("struct Peek : public Modify {\n"
                        "  static constexpr auto id = &Peek::id_restart_global;\n};")
    assert peeks.search("struct Peek : public Modify {\n  using Modify::id_restart_global;\n};")
    assert not peeks.search("class FixFSIMove : public FSI::FixFields {\n  int a;\n};")
    assert {file.name for file in sources() if peeks.search(file.read_text())} == {
        "fsi_lammps_access.cpp"}


NO_CODE = re.compile(r'"(\\.|[^"\\\n])*"|\'(\\.|[^\'\\])\'|//[^\n]*|/\*.*?\*/', re.S)


def long_functions(text, most):
    """First lines of bodies of more lines than that: of functions, members of classes and
    lambdas."""
    text = NO_CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)
    head, line, open_, found = "", 1, [], []
    for c in text:
        line += c == "\n"
        if c == "{":
            open_.append((line, head))
        elif c == "}" and open_:
            begin, of = open_.pop()
            if line - begin - 1 > most and not re.search(
                r"\b(namespace|struct|class|enum)\b[^()]*$", of):
                found.append(begin)
        head = "" if c in "{};" else head + c
    return sorted(found)


def sources():
    return [file for file in (*SOURCES.values(), *sorted((paths.ROOT / "src/KOKKOS").iterdir()))
            if file.suffix in (".h", ".cpp")]


def test_functions_fit_on_a_page():
    body = "\n" * 62
    assert long_functions("void f()\n{" + body + "}\n", 60) == [2]
    assert long_functions("struct A {\n  void f()\n  {" + body + "  }\n};\n", 60) == [3]
    assert long_functions("auto f = [&](int i) {" + body + "};\n", 60) == [1]
    assert long_functions("namespace A {" + body + "}\n", 60) == []
    assert long_functions("void f()\n{\n  // {" + body[:-3] + "}\n", 60) == []
    assert {file.name for file in sources() if long_functions(file.read_text(), 60)} == set()


def test_lines_are_not_wide():
    assert {file.name for file in sources()
            if any(len(line) > 100 for line in file.read_text().splitlines())} == set()


@pytest.mark.parametrize("folder", ["bench", "doc", "examples", "python", "unittest"])
def test_lines_of_python_are_not_wide(folder):
    """Outside of input scripts and pages in literals of several lines."""
    wide = []
    for file in (paths.ROOT / folder).rglob("*.py"):
        text = file.read_text()
        inside = set()
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type == tokenize.STRING and token.start[0] < token.end[0]:
                inside.update(range(token.start[0], token.end[0] + 1))
        wide += [f"{file.name}:{k}" for k, line in enumerate(text.splitlines(), 1)
                 if len(line) > 100 and k not in inside]
    assert not wide


@pytest.mark.parametrize("law", LAWS)
def test_laws_are_without_lammps(law):
    """A law could be compiled for a device: it includes other laws and the C++ library alone."""
    # without the rest of LAMMPS
    allowed = {f"fsi_{name}.h" for name in LAWS} | {"math_const.h", "math_eigen.h"}
    assert set(re.findall(r'#include "([^"]+)"', SOURCES[f"fsi_{law}.h"].read_text())) <= allowed


def test_build_names_sources_that_are_there():
    """Sources with compile options of their own are found by their names: of one with another name
    the options would be gone without a word."""
    patterns = re.findall(r'(?:INCLUDE|EXCLUDE) REGEX "([^"/]+)"',
                          (paths.ROOT / "cmake/FSIObjects.cmake").read_text())
    assert len(patterns) == 2
    for name in "|".join(patterns).split("|"):
        assert any(name in file for file in SOURCES), name
