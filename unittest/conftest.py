"""Lies here so that pytest, and processes that tests start, find scenes.py from the folders
below."""

import os
import shutil
import signal
import tempfile

import pytest

os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__),
                                            *filter(None, [os.environ.get("PYTHONPATH")])])
# Thousands of short runs side by side. A rank of Open MPI that waits leaves its core to others, or
# most of the time is spent on waiting; at its start it looks for no networks and, without mpirun,
# starts no server; and who ends with an error gives nobody a second to think about it
for name, value in {"mpi_yield_when_idle": "1", "pml": "ob1", "btl": "self,vader",
                    "ess_singleton_isolated": "1", "odls_base_sigkill_timeout": "0"}.items():
    os.environ.setdefault(f"OMPI_MCA_{name}", value)
os.environ.setdefault("OMP_WAIT_POLICY", "passive")  # so do threads
# Open MPI loads X11, OpenCL and XML with them, a sixth of its start
os.environ.setdefault("HWLOC_PLUGINS_PATH", os.devnull)
# its folder of sessions is removed by who leaves it empty, maybe while another process begins one
# there: one for each worker
os.environ["OMPI_MCA_orte_tmpdir_base"] = tempfile.mkdtemp(prefix="fsi_mpi_")


def pytest_unconfigure():
    shutil.rmtree(os.environ["OMPI_MCA_orte_tmpdir_base"], ignore_errors=True)


def pytest_addoption(parser):
    parser.addoption("--pairs-seed", type=int, default=0,
                     help="draws other scenes for unittest/pairs")
    parser.addoption("--last-case", action="store_true",
                     help="runs only the last case of each test with parameters")


def pytest_configure(config):
    config.addinivalue_line("markers", "slow: not in tools/test --quick")


LONGEST = 1200  # seconds; no test takes a tenth of it


def hangs(*_):
    raise TimeoutError(f"no end after {LONGEST} s: does a program wait for what does not come?")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol():
    """A test that hangs, as LAMMPS does on two ranks whose input script is missing, fails instead
    of all tests."""
    signal.signal(signal.SIGALRM, hangs)
    signal.alarm(LONGEST)
    yield
    signal.alarm(0)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Tests that share what a fixture of their file has run, or a folder, stay together
    (pytest-xdist, --dist loadgroup); others go where a core is free."""
    if config.getoption("--last-case"):
        items[:] = {(item.path, item.originalname): item for item in items}.values()
    for item in items:
        fixtures = item._fixtureinfo.name2fixturedefs.values()  # pylint: disable=protected-access
        if item.path.parent.name in ("tools", "docs") or any(definitions[-1].scope == "module"
                                                             for definitions in fixtures):
            item.add_marker(pytest.mark.xdist_group(item.path.name))
