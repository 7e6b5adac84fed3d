"""Lies here so that pytest, and processes that tests start, find scenes.py from the folders below."""

import os

os.environ["PYTHONPATH"] = os.pathsep.join([os.path.dirname(__file__), *filter(None, [os.environ.get("PYTHONPATH")])])
# Open MPI, of which tests start some two thousand processes for a moment each: a rank that waits leaves its core to others; nobody looks for
# networks (0.2 s); one rank alone needs no daemon; and an error need not give other ranks a second to end
for name, value in {"mpi_yield_when_idle": 1, "pml": "ob1", "ess_singleton_isolated": 1, "odls_base_sigkill_timeout": 0}.items():
    os.environ.setdefault(f"OMPI_MCA_{name}", str(value))
