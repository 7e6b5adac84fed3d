"""Lies here so that pytest, and processes that tests start, find scenes.py from the folders below."""

import os

os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__), *filter(None, [os.environ.get("PYTHONPATH")])])
# tests run side by side: a rank that waits (of Open MPI) leaves its core to others, or most of the time is spent on waiting
os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
