"""Sphinx configuration of the package's manual; pages are in the form of LAMMPS' own manual (tools/doc builds them)."""

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


def setup(app):
    app.add_lexer("LAMMPS", LAMMPSLexer)
