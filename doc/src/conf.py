"""Sphinx configuration of the package's manual; pages are in the form of LAMMPS' own manual (tools/doc builds them)."""

import os
import re
import shutil
from pathlib import Path

import markdown
from docutils import nodes
from docutils.parsers.rst import Directive
from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, String, Text

project = "FSI package for LAMMPS"
author = copyright = "the FSI package"
extensions = ["sphinx.ext.mathjax", "sphinx.ext.extlinks"]
extlinks = {"lammps": ("https://docs.lammps.org/%s.html", None)}
html_theme = "alabaster"
html_theme_options = {"page_width": "1100px", "sidebar_width": "240px", "description": "fluid-structure interaction by SPH"}
html_show_sphinx = False
root_doc = "index"


class LAMMPSLexer(RegexLexer):
    """What LAMMPS' manual calls code-block:: LAMMPS, so that pages can move there as they are."""

    name = "LAMMPS"
    aliases = ["lammps"]
    tokens = {"root": [(r"#.*?$", Comment), (r'"[^"]*"', String), (r"\$\{\w+\}|\$\w", Name.Variable),
                       (r"^(\s*)(\w+)", bygroups(Text, Keyword)), (r"[^\S\n]+|\n", Text), (r"[^\s#\"$]+", Text), (r".", Text)]}


# Markdown pages that have a page in the manual
PAGES = {"doc/results/README.md": "results", "doc/cost/README.md": "cost", "doc/choosing.md": "choosing", "doc/hard/README.md": "hard", "doc/scenes.md": "scenes",
         "doc/testing.md": "testing"} | {f"doc/cost/{p.name}": "cost" for p in (Path(__file__).parents[1] / "cost").glob("*.md") if p.name != "README.md"}
ROOT = Path(__file__).resolve().parents[2]


class Markdown(Directive):
    """``.. markdown:: FILE-OR-PATTERN ...``: Markdown files of the repository as they are, without their title; pictures are copied, links followed."""

    required_arguments, optional_arguments = 1, 100

    def run(self):
        env = self.state.document.settings.env
        found = []
        given = [Path(env.relfn2path(name)[1]) for name in self.arguments]
        for path in dict.fromkeys(path for pattern in given for path in sorted(pattern.parent.glob(pattern.name))):
            env.note_dependency(str(path))
            # a table may stand in a paragraph's place in GitHub's Markdown, and raw HTML may hold Markdown
            text = re.sub(r"(?m)^(?!\||\s*$)(.*)\n(?=\|[^\n]*\n\|[\s:|-]+$)", r"\1\n\n", path.read_text())
            text = re.sub(r"(?m)^(?![-*] |\d+\. |\s|$)(.*)\n(?=[-*] |1\. )", r"\1\n\n", text)
            text = text.replace("<details>", '<details markdown="1">')
            if len(self.arguments) == 1:
                text = re.sub(r"\A# .*\n", "", text)
            html = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "md_in_html"], output_format="html")
            html = re.sub(r'(href|src)="([^"#:]*)(#[^"]*)?"', lambda m: self.link(env.app, path, *m.groups()), html)
            if path.name != "README.md":
                html = f'<span id="{path.stem}"></span>' + html
            found.append(nodes.raw("", html.replace("<table>", '<table class="docutils">'), format="html"))
        return found

    def link(self, app, path, kind, target, anchor):
        """The attribute with a place that exists in the HTML: a page of the manual, a picture's copy, or none (pages that are
        only made by a run, and files that are none)."""
        anchor = anchor or ""
        if not target:
            return f'{kind}="{anchor}"'
        place = Path(os.path.normpath(path.parent / target))
        if kind == "src" and not place.exists():
            raise self.error(f"{path.name}: {target} does not exist")
        name = str(place.relative_to(ROOT))
        if name in PAGES:
            page = PAGES[name]
            return f'{kind}="{page}.html{anchor or ("#" + place.stem if place.name != "README.md" and page == "cost" else "")}"'
        if place.suffix == ".png":
            copy = Path(app.outdir) / "_images" / name.replace("/", "_")
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(place, copy)
            return f'{kind}="_images/{copy.name}"'
        return f'title="{name}"'


def setup(app):
    app.add_directive("markdown", Markdown)
    app.add_lexer("LAMMPS", LAMMPSLexer)
