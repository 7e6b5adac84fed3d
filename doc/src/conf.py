"""Sphinx configuration of the manual (tools/doc builds it).

The source folder is the repository itself: the pages of doc/src, in the form of LAMMPS' own manual,
and the Markdown pages of doc and examples as they are, so that a link between any two of them leads
to the same page here and where the repository is browsed.
"""

import posixpath
import shutil
from pathlib import Path

from docutils import nodes
from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, String, Text
from sphinx.util import logging

project = "FSI package for LAMMPS"
author = copyright = "the FSI package"
root_doc = "doc/src/index"
include_patterns = ["doc/**", "examples/*/README.md", "unittest/*/README.md"]
exclude_patterns = ["build*", "results", ".*", "doc/notes"]
extensions = ["sphinx_rtd_theme", "myst_parser", "sphinx.ext.mathjax", "sphinx.ext.extlinks"]
extlinks = {"lammps": ("https://docs.lammps.org/%s.html", "%s")}
myst_heading_anchors = 3
highlight_language = "text"  # of blocks in Markdown that name none

html_theme = "sphinx_rtd_theme"
html_theme_options = {"collapse_navigation": False, "navigation_depth": 3,
                      "prev_next_buttons_location": "both"}
html_title = html_short_title = project
html_show_sphinx = html_show_copyright = html_show_sourcelink = html_copy_source = False
html_static_path, html_css_files = ["_static"], ["manual.css"]

# MathJax 2 as Debian has it; what it takes to draw TeX as SVG goes beside the pages, so that
# formulas need no network
MATHJAX = Path("/usr/share/javascript/mathjax")
MATHJAX_PARTS = ("MathJax.js", "config/TeX-AMS_SVG.js", "extensions", "jax/element",
                 "jax/input/TeX", "jax/output/SVG/*.js", "jax/output/SVG/autoload",
                 "jax/output/SVG/fonts/TeX")
if MATHJAX.is_dir():
    mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_SVG"
    mathjax2_config = {"messageStyle": "none", "showMathMenu": False}


def copy_mathjax(app, error):
    for part in MATHJAX_PARTS if MATHJAX.is_dir() and not error else ():
        for source in MATHJAX.glob(part):
            target = Path(app.outdir) / "_static/mathjax" / source.relative_to(MATHJAX)
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.is_dir():
                shutil.copytree(source, target, dirs_exist_ok=True)
            else:
                shutil.copyfile(source, target)


def link_pages(app, doctree, docname):
    """A plain link to the source of a page, which a git host follows, leads to the page here."""
    for node in doctree.findall(nodes.reference):
        path, mark, place = node.get("refuri", "").partition("#")
        if path.endswith((".rst", ".md")) and "://" not in path:
            page = posixpath.normpath(posixpath.join(posixpath.dirname(docname),
                                                     path.rpartition(".")[0]))
            if page in app.env.found_docs:
                node["refuri"] = app.builder.get_relative_uri(docname, page) + mark + place
            else:
                logging.getLogger(__name__).warning("no page %s", path, location=node)


class LAMMPSLexer(RegexLexer):
    """What LAMMPS' manual calls code-block:: LAMMPS, so that pages can move there as they are."""

    name = "LAMMPS"
    aliases = ["lammps"]
    tokens = {"root": [(r"#.*?$", Comment), (r'"[^"]*"', String),
                       (r"\$\{\w+\}|\$\w", Name.Variable),
                       (r"^(\s*)(\w+)", bygroups(Text, Keyword)), (r"[^\S\n]+|\n", Text),
                       (r"[^\s#\"$]+", Text), (r".", Text)]}


def setup(app):
    app.connect("build-finished", copy_mathjax)
    app.connect("doctree-resolved", link_pages)
    app.add_lexer("LAMMPS", LAMMPSLexer)
