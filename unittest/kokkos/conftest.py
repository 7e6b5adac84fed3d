"""What is here needs LAMMPS with its package KOKKOS: elsewhere it is left out (tools/kokkos
--test)."""

from fsi import paths

CACHE = paths.BUILD / "CMakeCache.txt"
if not CACHE.exists() or "PKG_KOKKOS:BOOL=ON" not in CACHE.read_text():
    collect_ignore_glob = ["test_*.py"]
