# Headers that most of LAMMPS' sources include, its own and the language's, compiled once: half of the time that these take.
# Not for the package's sources, whose objects the compiler cache knows in all ways to build.
# What compiles for GPUs may know no such headers.
set(_default ON)
if(PKG_KOKKOS)
  set(_default OFF)
endif()
option(FSI_PCH "Precompile LAMMPS' headers" ${_default})
if(FSI_PCH)
  set(_headers atom comm domain error force memory modify neighbor update)
  list(TRANSFORM _headers REPLACE "(.+)" "${LAMMPS_SOURCE_DIR}/src/\\1.h")
  foreach(_header algorithm cmath cstring map set string vector)
    list(APPEND _headers "<${_header}$<ANGLE-R>")
  endforeach()
  target_precompile_headers(lammps PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${_headers}>")
endif()
