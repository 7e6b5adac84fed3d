"""What a git host shows without a build: links of the README and of the pages that it links lead to
files, and no page has words only Sphinx knows."""

import re
import subprocess
import sys

import pytest

from fsi import paths, quoted, results

ROOT = paths.ROOT
README = ROOT / "README.md"
ROLE = re.compile(r"(?<!`)(:[a-z:]+:`[^`]+`)")
PLAIN = (":math:", ":sub:", ":sup:", ":code:")  # roles of reStructuredText itself
DIRECTIVES = (
    "image figure code-block list-table csv-table math note warning container rubric raw".split())


def links(path):
    """Targets of links and pictures of a page that are files."""
    text = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.M | re.S)
    if path.suffix == ".md":
        found = re.findall(r"\]\(([^)\s]+)\)|(?:src|href)=\"([^\"]+)\"", text)
    else:
        found = re.findall(r"`[^`<]+<([^>]+)>`_|^ *(?:\.\. (?:image|figure)::|:target:) (\S+)",
                           text, re.M)
    return [target.partition("#")[0] for pair in found for target in pair if target
            and "://" not in target and not target.startswith("#")]


def unknown(text):
    """[roles and directives that only Sphinx knows]; a host leaves directives out, where the first
    line says so."""
    roles = [role for role in ROLE.findall(re.sub(r"``[^`]*``", "", text))
             if not role.startswith(PLAIN)]
    hidden = ("toctree",) if text.startswith(".. github display off\n\n") else ()
    return roles + [name for name in re.findall(r"^ *\.\. ([a-z-]+)::", text, re.M)
                    if name not in (*DIRECTIVES, *hidden)] + re.findall(r":file: \S+", text)


def linked():
    """Pages of the manual's own form that the README links."""
    return sorted({(README.parent / target).resolve() for target in links(README)
                   if target.endswith(".rst")})


@pytest.mark.parametrize("path", [README, *sorted({(ROOT / target) for target in links(README)
                                                   if target.endswith((".md", ".rst"))})],
                         ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_lead_to_files(path):
    named = subprocess.run(["git", "-C", ROOT, "ls-files", "-z", "--cached", "--others",
                            "--exclude-standard"], capture_output=True, text=True, check=True)
    files = {(ROOT / name).resolve() for name in named.stdout.split("\0") if name}
    missing = [target for target in links(path) if (path.parent / target).resolve() not in files]
    assert not missing


@pytest.mark.parametrize("path", linked(), ids=lambda path: path.stem)
def test_linked_pages_need_no_sphinx(path):
    assert unknown(path.read_text(encoding="utf-8")) == []


def test_what_only_sphinx_knows_is_seen():
    page = ("A\n=\n\nSee :doc:`b <c>` and :math:`x`, ``:doc:`d` ``.\n\n.. toctree::\n\n   b\n\n"
            ".. literalinclude:: in.a\n")
    assert unknown(page) == [":doc:`b <c>`", "toctree", "literalinclude"]
    assert unknown(".. github display off\n\n" + page) == [":doc:`b <c>`", "literalinclude"]
    assert len(linked()) > 5 and len(links(README)) > 30


@pytest.mark.parametrize("path", linked(), ids=lambda path: path.stem)
def test_docutils_reads_linked_pages(path):
    """As a git host does, nothing inserted; a message is an error."""
    core = pytest.importorskip("docutils.core")
    found = core.publish_parts(re.sub(r"^\.\. toctree::\n(?:   .*\n|\n(?=   ))*", "",
                                      path.read_text(encoding="utf-8"), flags=re.M),
                               writer_name="html",
                               settings_overrides={"file_insertion_enabled": False,
                                                   "raw_enabled": False, "halt_level": 2,
                                                   "report_level": 5,
                                                   "syntax_highlight": "none"})
    assert "system-message" not in found["html_body"] and "problematic" not in found["html_body"]


# ---- quoted decks ----

def test_a_quoted_deck_is_the_deck(tmp_path):
    (tmp_path / "in.a").write_text("# A\nvariable dx index 1\n\nunits si\nfix 1 all\n\nrun 1\n")
    page = ("Head\n\n.. deck in.a: units\n\n.. code-block:: LAMMPS\n\n   old\n\n   older\n\n"
            "* text\n\n.. deck in.a: # A to units\n\nmore\n")
    made = quoted.renewed(page, tmp_path)
    assert made == ("Head\n\n.. deck in.a: units\n\n.. code-block:: LAMMPS\n\n   units si\n"
                    "   fix 1 all\n\n* text\n\n"
                    ".. deck in.a: # A to units\n\n.. code-block:: LAMMPS\n\n   # A\n"
                    "   variable dx index 1\n\n   units si\n\nmore\n")
    assert quoted.renewed(made, tmp_path) == made
    with pytest.raises(quoted.Refusal, match="from 'gone' to 'the end of the paragraph'"):
        quoted.part("a\n", "gone")


def test_tutorials_show_all_of_their_decks():
    for name, deck in (("Howto_fsi", "doc/src/in.howto"),
                       ("tutorial_gate", "examples/elastic_gate/in.elastic_gate"),
                       ("tutorial_own_body", "doc/src/recipes/in.stl")):
        text = (ROOT / f"doc/src/{name}.rst").read_text(encoding="utf-8")
        missing = [line for line in (ROOT / deck).read_text(encoding="utf-8").splitlines()
                   if line.strip() and f"   {line}\n" not in text]
        assert not missing, f"{name}.rst lacks {missing}"


# ---- the first screen ----

def test_readme_is_short_and_names_what_is_on_by_default():
    sys.path.insert(0, str(ROOT / "bench"))
    import effects  # noqa: PLC0415
    text = README.read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 99
    pages = {"hourglass 0.05": "pair_fsi_solid_tl", "gradient quadratic": "pair_fsi_solid_tl",
             "volumetric auto": "pair_fsi_solid_tl",
             "solid/guard 0.5": "pair_fsi_fluid", "mach 1": "fix_fsi"}
    for default, page in pages.items():
        assert f"*{default}*" in text and f"*{default}*" in effects.DEFAULTS
        assert default in " ".join((ROOT / f"doc/src/{page}.rst").read_text(
            encoding="utf-8").partition("\nDefault\n")[2].split())


def test_readme_states_the_rule_of_its_table():
    found = results.scenes_of(paths.PAGE)
    text = README.read_text(encoding="utf-8")
    assert "\n".join(results.rule({"scenes": found})) in text
