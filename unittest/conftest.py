"""Lies here so that pytest, and processes that tests start, find scenes.py from the folders below."""

import os

os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__), *filter(None, [os.environ.get("PYTHONPATH")])])
# tests run side by side: a rank that waits (of Open MPI) leaves its core to others, or most of the time is spent on waiting
os.environ.setdefault("OMPI_MCA_mpi_yield_when_idle", "1")
# Thousands of short runs: Open MPI looks for networks at each start, starts a server beside a process without mpirun, and leaves each run that
# ends with an error a second to think about it
for name, value in {"pml": "ob1", "btl": "self,vader", "ess_singleton_isolated": "1", "odls_base_sigkill_timeout": "0"}.items():
    os.environ.setdefault(f"OMPI_MCA_{name}", value)
