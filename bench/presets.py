"""The manual's table of presets, from that in the sources (src/FSI/fsi_preset.h)."""

import re

from tool import as_csv

from fsi import paths

TABLE = paths.ROOT / "src/FSI/fsi_preset.h"
ROW = r'\{"(\w+)", "([^"]+)", (true|false), (true|false), (?:true|false),\s*"([^"]+)"\}'


def table():
    """[(name, scenes, quintic, background, keywords)]"""
    return [(name, scenes, quintic == "true", background == "true", keywords)
            for name, scenes, quintic, background, keywords in re.findall(ROW, TABLE.read_text())]


def page():
    """The rows of the table as CSV."""
    rows = [[name, scenes, "quintic 1; Wendland 1.5" if quintic else "Wendland 1.5",
             "sound 10 U" + " background/speed U" * background + f" {keywords}"]
            for name, scenes, quintic, background, keywords in table()]
    return as_csv([["preset", "for", "kernel, h/dx (2D; 3D)", "keywords"], *rows])
