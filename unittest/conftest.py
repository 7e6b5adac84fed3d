"""Lies here so that pytest, and processes that tests start, find scenes.py from the folders below."""

import os

import pytest

os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__), *filter(None, [os.environ.get("PYTHONPATH")])])
# Open MPI, of which tests start some two thousand processes for a moment each: a rank that waits leaves its core to others; nobody looks for
# networks (0.2 s); one rank alone needs no daemon; and an error need not give other ranks a second to end
for name, value in {"mpi_yield_when_idle": 1, "pml": "ob1", "ess_singleton_isolated": 1, "odls_base_sigkill_timeout": 0}.items():
    os.environ.setdefault(f"OMPI_MCA_{name}", str(value))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Tests that share what a fixture of their file has run stay together (pytest-xdist, --dist loadgroup); all others go wherever a core is free."""
    for item in items:
        if any(definitions[-1].scope == "module" for definitions in item._fixtureinfo.name2fixturedefs.values()):  # pylint: disable=protected-access
            item.add_marker(pytest.mark.xdist_group(item.path.name))
