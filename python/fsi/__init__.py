"""Reads, measures and draws what runs of the LAMMPS FSI package leave behind.

Lengths are in metres, times in seconds, pressures in pascal, unless a docstring says otherwise.
Needs numpy and matplotlib, nothing else.
"""

import importlib
import sys


def __getattr__(name):
    """Modules on demand: `from fsi import dump` in a python that lacks what they need says which
    one has it."""
    if not name.startswith("_"):
        try:
            return importlib.import_module(f"{__name__}.{name}")
        except ModuleNotFoundError as error:
            if error.name in ("numpy", "matplotlib"):
                from .__main__ import able_python  # pylint: disable=import-outside-toplevel
                other = able_python()
                raise ModuleNotFoundError(
                    f"fsi.{name} needs {error.name}, which {sys.executable} does not have; "
                    + (f"{other} has it" if other else "nor has another python here: install it"),
                    name=error.name) from None
            if error.name != f"{__name__}.{name}":
                raise
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
