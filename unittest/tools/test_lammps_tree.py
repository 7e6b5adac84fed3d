"""tools/lammps-tree: the package in LAMMPS' own tree, as a merge request would have it."""

import re
import subprocess
import sys
from collections import Counter

import pytest

from fsi import paths

LAMMPS = paths.lammps_source()
TOOL = paths.ROOT / "tools/lammps-tree"
PAGES = paths.ROOT / "doc/src"
TOOL_TEXT = TOOL.read_text()
EXAMPLES = "examples/PACKAGES/fsi"
PACKAGES = next(page for page in ("doc/src/Packages_list.rst", "doc/src/Packages.rst")
                if (LAMMPS / page).exists())


def lay(folder, *options):
    return subprocess.run([sys.executable, TOOL, folder, "--lammps", LAMMPS, *options], text=True,
                          capture_output=True)


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """The files that are new or changed"""
    folder = tmp_path_factory.mktemp("lammps") / "tree"
    done = lay(folder, "--changes")
    assert done.returncode == 0, done.stderr
    return folder


def left_out():
    listed = TOOL_TEXT.partition("LEFT_OUT = {")[2].partition("}")[0]
    return set(re.findall(r'"(\w+)":', listed))


def test_sources_are_all_there(tree):
    for package, some in (("FSI", {"README", "fix_fsi.cpp"}),
                          ("FSI-CLASSIC", {"README", "pair_fsi_solid.cpp"}),
                          ("OPENMP", {"pair_fsi_fluid_omp.cpp"}),
                          ("KOKKOS", {"pair_fsi_fluid_kokkos.cpp"})):
        sources = {path.name: path.read_text()
                   for path in (paths.ROOT / "src" / package).glob("[!.]*")}
        assert {path.name: path.read_text()
                for path in (tree / "src" / package).iterdir()} == sources
        assert some <= set(sources)
        ignored = set((tree / "src/.gitignore").read_text().split())
        assert {f"/{name}" for name in sources if name != "README"} <= ignored


@pytest.mark.parametrize("file, line", [
    ("cmake/CMakeLists.txt", "  FSI"), ("cmake/presets/all_on.cmake", "  FSI"),
                                        ("cmake/presets/all_off.cmake", "  FSI"),
    ("cmake/presets/most.cmake", "  FSI"), ("src/Makefile", "\tfsi \\"),
                                        ("doc/src/Build_package.rst", "   * :ref:`FSI <fsi>`"),
    ("doc/src/Build_extras.rst", ".. _fsi:"), (PACKAGES, "   * - :ref:`FSI <PKG-FSI>`"),
    ("cmake/CMakeLists.txt", "  FSI-CLASSIC"), ("src/Makefile", "\tfsi-classic \\"),
    ("cmake/CMakeLists.txt", "pkg_depends(FSI-CLASSIC FSI)"),
    ("doc/src/Commands_pair.rst", "   * :doc:`fsi/fluid (ko) <pair_fsi_fluid>`"),
    (PACKAGES, "   * - :ref:`FSI-CLASSIC <PKG-FSI-CLASSIC>`"),
    ("doc/src/Packages_details.rst", ".. _PKG-FSI-CLASSIC:"),
    ("doc/src/Packages_details.rst", ".. _PKG-FSI:"), ("doc/src/Howto.rst", "   Howto_fsi"),
                                        ("doc/src/commands_list.rst", "   fsi_set")])
def test_lists_name_the_package(tree, file, line):
    assert (tree / file).read_text().splitlines().count(line) == 1


def test_lines_of_lammps_stay(tree):
    """Two lines change: the packages that have a CMake file of their own, and the atom styles."""
    gone = Counter()
    for path in tree.rglob("*"):
        old = LAMMPS / path.relative_to(tree)
        if path.is_file() and old.exists():
            gone += Counter(old.read_text().splitlines()) - Counter(path.read_text().splitlines())
    assert len(gone) == 2 and all("EXTRA-COMMAND" in line or "*ellipsoid* or *full*" in line
                                  for line in gone)


def test_no_page_is_forgotten(tree):
    """A page is in the tree, under its name or that of a Howto, or the tool says why not."""
    renamed = dict(re.findall(r'"(\w+)": "(Howto_fsi\w*)"', TOOL_TEXT))
    for page in (path.stem for path in PAGES.glob("*.rst")):
        name = renamed.get(page, page.replace("Howto_", "Howto_fsi_") if page.startswith("Howto_")
                           else page)
        assert (tree / f"doc/src/{name}.rst").exists() != (page in left_out()), page
    assert not left_out() - {path.stem for path in PAGES.glob("*.rst")}


def test_pages_are_those_of_lammps_manual(tree):
    """No role of this repository is left, and what pages name is there: pages, pictures, decks,
    labels."""
    new = [path for path in (tree / "doc/src").glob("*.rst")
           if not (LAMMPS / "doc/src" / path.name).exists()]
    pages = {path.stem for path in [*(LAMMPS / "doc/src").glob("*.rst"), *new]}
    labels = [label for path in new for label in re.findall(r"^\.\. _([\w-]+):$", path.read_text(),
                                                            re.M)]
    assert len(labels) == len(set(labels)) > 20
    theirs = "\n".join(path.read_text() for path in (LAMMPS / "doc/src").glob("*.rst"))
    assert not [label for label in labels if f".. _{label}:\n" in theirs]
    listed = "\n".join(path.read_text() for path in (tree / "doc/src").glob("*.rst"))
    for path in new:
        text = path.read_text()
        # LAMMPS lists pages of these by itself (doc/utils/make-globbed-tocs.py)
        if not path.name.startswith(("pair_", "fix_", "compute_")):
            assert f"\n   {path.stem}\n" in listed, f"{path.name} is in no toctree"
        assert text.isascii(), path.name
        assert not [word for word in (":lammps:", "tools/", "build/lmp") if word in text], path.name
        for target in re.findall(r":doc:`(?:[^<`]*<)?([^>`]+)>?`", text):
            assert target in pages, f"{path.name}: {target}"
        for label in re.findall(r":ref:`[^<`]+<([^>`]+)>`", text):
            assert label in labels, f"{path.name}: {label}"
        for file in re.findall(r"(?:figure::|literalinclude::|:file:) (\S+)", text):
            assert (tree / "doc/src" / file).exists(), f"{path.name}: {file}"
        if re.match(r"\.\. index:: ", text):
            package = "FSI-CLASSIC" if path.name == "pair_fsi_solid.rst" else "FSI"
            assert ".. versionadded:: TBD" in text and f"part of the {package} package" in text


def test_words_for_the_spelling_check(tree):
    """LAMMPS' list has them once, and each is on a page."""
    words = re.search('WORDS = """(.*?)"""', TOOL_TEXT, re.S)[1].split()
    listed = (tree / "doc/utils/sphinx-config/false_positives.txt").read_text().split()
    pages = "".join(path.read_text() for path in (tree / "doc/src").glob("*fsi*.[rc]s[tv]"))
    for word in words:
        assert listed.count(word) == 1 and re.search(rf"\b{word}\b", pages, re.I), word


def test_no_deck_is_forgotten(tree):
    """Recipes are examples, but for those of pages that are left out. They write no files, and
    their materials are there."""
    decks = {path.name for path in (PAGES / "recipes").iterdir()}
    decks -= {"in.flap_stream", "in.spring", "in.stl", "cup.stl"}
    found = {path.name for path in (tree / EXAMPLES).iterdir()}
    assert found == decks | {"in.shelf", "README", "materials.fsi"} | {path for path in found
                                                                       if path.startswith("log.")}
    materials = tree / "potentials/materials.fsi"
    assert (tree / EXAMPLES / "materials.fsi").resolve() == materials.resolve()
    for deck in (tree / EXAMPLES).glob("in.*"):
        assert not re.search(r"^dump |cpu", deck.read_text(), re.M)
    for name in ("shelf", "float", "half"):
        for ranks in (1, 4):
            text = (tree / EXAMPLES / f"log.4Feb25.{name}.g++.{ranks}").read_text()
            assert "Total wall time" in text and f"on {ranks} procs" in text


@pytest.mark.parametrize("check", ["homepage", "errordocs", "permissions", "whitespace", "fmtlib"])
def test_coding_standard(tree, check):
    """LAMMPS' own checks. versiontags is for releases: it names what is still 'TBD', as
    contributors are to write."""
    python = next(p for p in (sys.executable, "/usr/bin/python3")
                  if subprocess.run([p, "-c", "import yaml"], capture_output=True).returncode == 0)
    done = subprocess.run([python, LAMMPS / f"tools/coding_standard/{check}.py", tree], text=True,
                          capture_output=True)
    assert (done.returncode, done.stdout) == (0, ""), done.stdout + done.stderr


def test_refusals(tmp_path):
    (tmp_path / "there").mkdir()
    for folder, lammps, message in ((tmp_path / "there", LAMMPS, "exists: give a new folder"),
                                    (tmp_path / "new", tmp_path, "is not a LAMMPS source tree")):
        done = subprocess.run([sys.executable, TOOL, folder, "--lammps", lammps], text=True,
                              capture_output=True)
        assert done.returncode == 1 and message in done.stderr and not (tmp_path / "new").exists()


def test_references_are_those_of_numpy(tmp_path, monkeypatch):
    """The tests of LAMMPS' frame are what unittest/lammps/make_yaml.py writes. Round-off differs
    between libraries of linear algebra: 1e-9 of numbers, of which the smallest are sums that cancel
    to a thousandth."""
    for folder in ("unittest/styles", "unittest/lammps"):
        monkeypatch.syspath_prepend(paths.ROOT / folder)
    import make_yaml
    make_yaml.main(tmp_path)
    written = {path.name: path.read_text().split() for path in tmp_path.iterdir()}
    assert len(written) == 12
    for name, words in written.items():
        kept = (make_yaml.TESTS / name).read_text().split()
        assert len(kept) == len(words)
        for a, b in zip(kept, words):
            if a != b:
                assert float(a) == pytest.approx(float(b), rel=1e-9, abs=1e-12), name
