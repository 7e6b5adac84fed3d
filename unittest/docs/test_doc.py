"""The manual says what LAMMPS takes: every command under Examples runs, every keyword in the
sources has its place on the page."""

import re
import subprocess

import pytest
from decks import FIX, GRAVITY, PAIRS, SETUP, STRESS
from scenes import run

from fsi import launch, paths

COMMANDS = ("fsi_clamp", "fsi_displace", "fsi_dump", "fsi_material", "fsi_pack", "fsi_run",
            "fsi_set")
PAGES = paths.ROOT / "doc/src"
SOURCES = paths.sources()
STYLES = {re.sub(r"\W", "_", f"{kind.lower()}_{name}"): name
          for header in paths.sources("*.h").values()
          for kind, name in re.findall(
              r"^(Pair|Fix|Compute|Command|Atom)Style\(((?:(?!/omp,)[^,])+),", header.read_text(),
              re.M)}
STYLES["atom_style_fsi"] = STYLES.pop("atom_fsi")
for name in COMMANDS:
    STYLES.pop(f"command_{name}")
STYLES |= {name: name.replace("_", "/") for name in COMMANDS}
STYLES.pop("fix_FSI_REFERENCE")  # internal
STYLES.pop("fix_FSI_HISTORY")
STYLES.pop("fix_fsi_outlet")  # on the page of fix fsi/inlet


def lagrangian(text):
    return text.replace("fsi/solid", "fsi/solid/tl")


def examples(page):
    """Commands under Examples, a continued line as one; commands of one paragraph belong
    together."""
    text = (PAGES / f"{page}.rst").read_text()
    block = re.search(r'^Examples\n"+\n\n\.\. code-block:: LAMMPS\n\n((?:   .*\n|\n)+)', text,
                      re.M)[1]
    paragraphs = [re.sub(r"^ +", "", p.strip("\n"), flags=re.M) for p in re.split(r"\n\s*\n", block)
                  if p.strip()]
    return (paragraphs if page.startswith("pair") or page in ("fix_fsi_spectrum", "fsi_pack")
            else [line for p in paragraphs for line in p.splitlines()])


def deck(page, example):
    """A scene of water and plate in which the example is one of the commands."""
    if page == "atom_style_fsi":
        return SETUP
    if page == "pair_fsi_grain":    # the plate's particles are grains
        grains = SETUP.replace("atom_style fsi",
                               "atom_style hybrid fsi sphere\ncomm_modify vel yes")
        return (grains + "set type 2 diameter 0.004\nset type 2 density/disc 2500\n" + example
                + "\n" + FIX + "run 1\n")
    if page.startswith("pair"):
        return SETUP + example + "\n" + FIX + (STRESS if re.search(r"fsi/solid(?!/)", example)
                                               else "") + "run 1\n"
    sub = "substeps" in example
    pairs = lagrangian(PAIRS) if sub else PAIRS
    if page == "fix_fsi_wall_particle":
        walls = SETUP.replace("create_box 2", "create_box 3").replace(
            "group water", "region wall block -0.04 0 -0.04 0.1 INF INF units box\n"
            "create_atoms 3 region wall\ngroup wall type 3\ngroup water")
        pairs = PAIRS.replace("water plate", "water plate wall").replace("NULL plate",
                                                                         "NULL plate NULL")
        return walls + pairs + FIX.replace("all", "fluid").replace(
            "fix", "group fluid subtract all wall\nfix",
            1) + STRESS + GRAVITY + example + "\nrun 1\n"
    if page in ("fix_fsi_stream", "fix_fsi_inlet"):
        lines = examples(page)    # region and variable stand before the fix that has them
        # for buffers and what leaves them
        room = SETUP.replace("-0.05 0.3 -0.05 0.3", "-0.06 0.3 -0.06 0.3")
        return room + PAIRS + FIX + STRESS + "\n".join(line for line in lines
                                                       if not line.startswith("fix") and line
                                                       != example) + f"\n{example}\nrun 1\n"
    if page == "fix_fsi_refine":
        # region and variable stand before the fix that has them
        lines = "\n".join(line for line in examples(page) if not line.startswith("fix"))
        finest = "finest" in example
        pairs = PAIRS.replace("water plate", "water plate levels" if finest
                              else "water plate water").replace("NULL plate", "NULL plate levels"
                                                                if finest else "NULL plate NULL")
        levels = FIX if finest else FIX.replace("1.5", "1.5 spacing 3 0.0070711")
        return (SETUP.replace("create_box 2", "create_box 6" if finest else "create_box 3") + pairs
                + levels + STRESS + f"{lines}\n{example if example.startswith('fix') else ''}\n"
                "run 1\n")
    if page == "fsi_clamp":
        parts = ("region foot block INF 0.12 INF INF INF INF units box\ngroup plates type 2\n"
                 "group foot region foot\ngroup wall intersect plates foot\n"
                 "group moving subtract all wall\n")
        return SETUP + parts + lagrangian(PAIRS) + FIX.replace("all",
                                                               "moving") + example + "\nrun 1\n"
    if page == "fix_fsi_move":
        moves = FIX.replace("all", "water") + "group wall type 2\ngroup blades type 2\n"
        lines = examples(page)  # variables stand before the fix that has them
        return SETUP + PAIRS + moves + STRESS + "\n".join(
            line for line in lines if line.startswith("variable")) + f"\n{example}\nrun 1\n"
    if "c_shear" in example:
        example = "\n".join(line for line in examples(page)
                            if line.startswith("compute shear")) + f"\n{example}"
    fix = "" if page == "fix_fsi" else FIX
    stress = "" if sub or page == "fix_fsi_stress" else STRESS
    return SETUP + pairs + fix + stress + GRAVITY + example + "\nrun 1\n"


CASES = [(page, example) for page in STYLES for example in examples(page)]


@pytest.mark.parametrize("page, example", CASES,
                         ids=[f"{p}-{e.splitlines()[0][:60]}" for p, e in CASES])
def test_example(tmp_path, page, example):
    run(tmp_path, deck(page, example))


def code_of(page, name):
    """The source of a style: a file of its name, or, in that of another style, what follows the
    line that names it."""
    parts = re.compile(r"^// ---- (\w+(?:/\w+)*) ----\n", re.M)
    for file in SOURCES.values():
        first, *others = parts.split(file.read_text())
        if file.name == f"{page}.cpp":
            return first
        if name in others[::2]:
            return others[others.index(name) + 1]
    return ""


@pytest.mark.parametrize("page, name", [*STYLES.items(), ("fix_fsi_inlet", "fsi/outlet")])
def test_page_has_every_keyword(page, name):
    """Words that the source compares arguments with, as a user may write them, stand on the
    page."""
    text = (PAGES / f"{page}.rst").read_text()
    title = (name if page in COMMANDS
             else f"{page.split('_fsi')[0].replace('pair', 'pair_style')} {name}")
    assert f".. index:: {title}\n" in text and f"\n{title} command\n===" in text
    code = code_of(page, name)
    words = set(re.findall(r'strcmp\(arg\[[^\]]*\](?:, | \+ \d\], )"([^"]+)"\)', code)) | set(
        re.findall(r'key == "([^"]+)"', code))
    words |= set(re.findall(r'^    \{"(\w+)", "', code, re.M))  # fix fsi/watch
    words |= set(re.findall(r'(?:\.key|or_word)\("([^"]+)"', code))
    for choice in re.findall(r"(?:choice\([^{};]*|names = |modes = )\{([^}]*)\}", code):
        words |= set(re.findall(r'"([^"]+)"', choice))
    if page == "pair_fsi_solid_tl":
        words |= {law for file in paths.sources("fsi_*.h").values()
                  for law in re.findall(r'NAME\[\] = "(\w+)"', file.read_text())}
    words -= {"*", "NULL"}
    missing = sorted(w for w in words if w not in text)
    assert not missing, f"The source knows {missing}, {page}.rst does not"
    syntax = text.partition("\nExamples\n")[0]
    missing = sorted(key for key in re.findall(r'\.key\("([^"]+)"', code)
                     if f"*{key}*" not in syntax and f"{name} {key} " not in syntax)
    assert not missing, f"Syntax of {page}.rst lacks {missing}"


def run_time_messages():
    """[words] of what the sources say about atoms and steps, not arguments; of each message the
    longest part between its numbers."""
    found = []
    for source in paths.sources("*.cpp").values():
        code = source.read_text()
        for text in re.findall(r'(?:FLERR,\s+|fmt::format\(\s*|c\.warn\(\s*)((?:"[^"]*"\s*)+)',
                               code):
            text = re.sub(r"\{[^}]*\}", "|", re.sub(r'"\s*"', "", text).strip().strip(
                '"')).removeprefix("Fix fsi/dt: ")
            if re.match(r"(\w+ )*atoms? (type )?\||on step \|", text, re.I):
                found.append(max((part.strip(" ,.") for part in text.split(":")[0].split("|")),
                                 key=lambda part: len(part.split())))
        if source.stem == "fix_fsi_watch":
            found += re.findall(r'\{[A-Z]+, "\w+", "([^"]+)"', code)
    return found


def test_run_time_messages_are_among_the_symptoms():
    text = " ".join(
        (PAGES / "troubleshooting.rst").read_text().replace("*", "").replace("\\", "").split())
    messages = run_time_messages()
    assert len(messages) > 20 and min(len(m.split()) for m in messages) >= 2
    missing = [m for m in messages if m not in text]
    assert not missing, f"doc/src/troubleshooting.rst lacks {missing}"


def test_every_command_is_on_the_page_of_commands():
    """That no page is left out of the contents is Sphinx' own warning."""
    text = (PAGES / "Commands_fsi.rst").read_text()
    assert not [page for page in STYLES if f" <{page}.rst>`__" not in text]


def test_every_bundled_material_is_on_its_page():
    names = re.findall(r"^(\w+) +(?:fluid|solid|wall) ",
                       (paths.POTENTIALS / "materials.fsi").read_text(), re.M)
    text = (PAGES / "materials.csv").read_text()
    assert len(names) > 10 and not [name for name in names if f"*{name}*" not in text]


def test_citation():
    """Fix fsi and doc/roadmap.md name authors, title and version as CITATION.cff does."""
    entry = re.search(r"```text\n(.*?)```", (paths.ROOT / "doc/roadmap.md").read_text(), re.S)[1]
    code = re.search(r"cite_fsi\[\] =(.*?);", SOURCES["fix_fsi.cpp"].read_text(), re.S)[1]
    said = "".join(re.findall(r'"(.*?)"', code)).replace("\\n", "\n")
    assert said.partition("\n\n")[2].strip() == entry.strip()
    cff = (paths.ROOT / "CITATION.cff").read_text().partition("\nreferences:")[0]
    names = re.findall(r"^  - name: (.*)", cff, re.M)
    assert f" author = {{{' and '.join(f'{{{name}}}' for name in names)}}},\n" in entry
    assert f" title = {{{re.search('^title: (.*)', cff, re.M)[1]}}},\n" in entry
    assert (" note = {Version "
            f"{re.search('^version: (.*)', cff, re.M)[1].strip(chr(34))}}}\n" in entry)


def test_page_of_a_command_has_the_form_of_lammps():
    """Sections in LAMMPS' order, what it asks of each page, and the version since which the command
    is there."""
    sections = ["Syntax", "Examples", "Description", "Restrictions", "Related commands", "Default"]
    version = re.search(r'^version: "(.*)"', (paths.ROOT / "CITATION.cff").read_text(), re.M)[1]
    for page in STYLES:
        text = (PAGES / f"{page}.rst").read_text()
        words = " ".join(text.split())
        heads = [head for head in re.findall(r'^(.+)\n"{3,}$', text, re.M) if head in sections]
        assert heads == sections, page
        assert re.search(r"with that package (?:\(:doc:`Build_fsi`\)|\. See)", words), page
        since = re.search(r"\.\. versionadded:: (\S+)", text)
        assert since and since[1] <= version, page
        if page.startswith("pair"):
            assert "Mixing, shift, table, tail correction, restart, rRESPA info\n" in text, page
            assert (page == "pair_fsi_solid"
                    or ":lammps:`pair_modify` shift, table, and tail options" in words), page
            assert (page in ("pair_fsi_solid", "pair_fsi_grain")
                    or "*pe* is 0: use :doc:`compute fsi/energy" in words), page
        elif page.startswith("fix"):
            assert "Restart, fix_modify, output, run start/stop, minimize info\n" in text, page
            assert ("the *start/stop* keywords of the :lammps:`run` command" in words
                    and ":lammps:`fix_modify` options" in words), page


def test_every_file_of_tests_says_what_it_tests():
    """In its first line, which a command of the contributor guide lists."""
    files = sorted((paths.ROOT / "unittest").glob("*/test_*.py"))
    assert len(files) > 50 and not [path.name for path in files
                                    if not re.match(r'r?"""\w.{20}', path.read_text())]


def test_howto_deck(tmp_path):
    """The deck of the Howto, shortened to the first contact."""
    text = (PAGES / "in.howto").read_text()
    assert "fsi/run       0.2 " in text
    log = run(tmp_path, text.replace("fsi/run       0.2 ", "fsi/run 0.11 ")).output
    energy = [float(line.split()[-1]) for line in log.splitlines()
              if re.match(r"\s+\d+ +[\d.e-]+ +[\d.e-]+ +\d", line)]
    assert len(energy) >= 2 and abs(energy[-1] / energy[0] - 1.0) < 1e-3


def test_manual(tmp_path):
    """Builds without a warning: no link or picture of any page is dead. Nothing in it comes from
    the net, and links are words."""
    done = subprocess.run([paths.ROOT / "tools/doc", str(tmp_path)], env=launch.environment(),
                          stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == 0, done.stdout
    pages = {page.relative_to(tmp_path).as_posix(): page.read_text()
             for page in tmp_path.rglob("*.html") if "_static" not in page.parts}
    assert {f"doc/src/{page}.html" for page in STYLES} | {
        f"{paths.folder(name).parent.name}/{name}/README.html"
        for name in paths.scenes()} <= set(pages)
    for name, text in pages.items():
        assert not re.search(r'(?:src|<link[^>]*href)="(?:https?:)?//', text), name
        assert not re.search(r">https?://", text), name
    assert re.search(r'<script[^>]*src="[./]*_static/mathjax/MathJax.js\?config=',
                     pages["doc/src/theory.html"])
    assert (tmp_path / "_static/mathjax/jax/output/SVG/fonts/TeX/Main/Regular/Main.js").exists()
    assert "doc/src/index.html" in pages["index.html"]


MEASURED = [page for folder in ("results", "cost", "hard")
            for page in sorted((paths.ROOT / "doc" / folder).glob("*.md"))]


@pytest.mark.parametrize("page", [*MEASURED, paths.ROOT / "README.md", PAGES / "evidence.rst"],
                         ids=lambda page: f"{page.parent.name}/{page.stem}")
def test_measured_pages_name_no_commit(page):
    """It is in their data (test_renew.py), where who reads a number can go back to what gave it."""
    assert not re.search(r"\b(?=[0-9a-f]*[0-9])(?=[0-9a-f]*[a-f])[0-9a-f]{7,40}\b",
                         page.read_text(encoding="utf-8"))
