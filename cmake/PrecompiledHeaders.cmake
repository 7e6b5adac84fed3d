# Headers that most sources include, LAMMPS' and the language's, compiled once: half of the time that LAMMPS' own take.
option(FSI_PCH "Precompile LAMMPS' headers" ON)
if(FSI_PCH)
  set(_headers atom comm domain error force memory modify neighbor update)
  list(TRANSFORM _headers REPLACE "(.+)" "${LAMMPS_SOURCE_DIR}/src/\\1.h")
  foreach(_header algorithm cmath cstring map set string vector)
    list(APPEND _headers "<${_header}$<ANGLE-R>")
  endforeach()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(lammps PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)    # for the compiler cache
  endif()
  target_precompile_headers(lammps PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${_headers}>")
  # those of the package with options of their own could not use them
  if(NOT FSI_INSTRUMENT)
    target_precompile_headers(fsi PRIVATE ${_headers})
    set_property(SOURCE ${_small} PROPERTY SKIP_PRECOMPILE_HEADERS ON)
  endif()
endif()
