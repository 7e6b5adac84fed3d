# Release flags: -O3 without the errno and trap bookkeeping that keeps loops with sqrt() from vectorising.
# Not -ffast-math: the watchdogs must see NaN and Inf, and sums must keep their order on every rank count.
option(FSI_NATIVE "Compile for this machine's own instruction set (-march=native)" OFF)
option(FSI_COVERAGE "Instrument for line coverage (gcov)" OFF)
set(FSI_INSTRUMENT "" CACHE STRING "Extra compile options for src/FSI alone, e.g. -O0")
set(FSI_SANITIZE "" CACHE STRING "Sanitizers to build with, e.g. address,undefined")

if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
  # CMake's own choice is replaced, a user's is not
  if(CMAKE_CXX_FLAGS_RELEASE STREQUAL "-O3 -DNDEBUG")
    set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG -fno-math-errno -fno-trapping-math" CACHE STRING "" FORCE)
  endif()
  # liblammps is shared (Python, plugin): let calls inside it be inlined all the same
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    string(APPEND CMAKE_CXX_FLAGS_RELEASE " -fno-semantic-interposition")
  endif()
  if(FSI_NATIVE)
    string(APPEND CMAKE_CXX_FLAGS_RELEASE " -march=native")
  endif()
  # of the package alone: LAMMPS' own objects come from the compiler cache; both may be on at once
  if(FSI_COVERAGE OR FSI_SANITIZE)
    list(APPEND FSI_INSTRUMENT -O1 -g1)
  endif()
  if(FSI_COVERAGE)
    list(APPEND FSI_INSTRUMENT --coverage)
  endif()
  if(FSI_SANITIZE)
    list(APPEND FSI_INSTRUMENT -fsanitize=${FSI_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  endif()
endif()

find_program(FSI_CCACHE ccache)
if(FSI_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # headers that are compiled once: macros and times in them do not matter, and their 60 MB are not read for each source
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CMAKE_COMMAND};-E;env;CCACHE_SLOPPINESS=pch_defines,time_macros;CCACHE_INODECACHE=1;${FSI_CCACHE}" CACHE STRING "")
endif()
