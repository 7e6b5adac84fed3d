# Adds LAMMPS as a subproject with the styles of FSI_SOURCE_DIRS in its style headers. No patch: LAMMPS' own
# RegisterStyles() collects our headers before its CMakeLists writes style_*.h.
option(FSI_COMPILED_IN "The package is part of LAMMPS (OFF: of the plugin only)" ON)

# What the bundled decks need (GRAPHICS: dump image, since 2026 a package). More: -DPKG_<NAME>=ON.
foreach(pkg RIGID GRANULAR PLUGIN GRAPHICS)
  option(PKG_${pkg} "LAMMPS package ${pkg}" ON)
endforeach()
option(BUILD_SHARED_LIBS "Build liblammps as a shared library (Python, plugins)" ON)
# threads, which the styles of src/OPENMP take from LAMMPS
option(BUILD_OMP "Build with OpenMP" ${OpenMP_CXX_FOUND})
option(PKG_OPENMP "LAMMPS package OPENMP" ${BUILD_OMP})
option(BUILD_TOOLS "Build LAMMPS' tools" OFF)

include("${LAMMPS_SOURCE_DIR}/cmake/Modules/StyleHeaderUtils.cmake")
if(FSI_COMPILED_IN)
  foreach(_package ${FSI_SOURCE_DIRS})
    RegisterStyles("${_package}")
  endforeach()
endif()

# Our targets land beside lmp, whatever LAMMPS' own CMakeLists makes of its binary folder
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")
# an installed lmp finds its liblammps beside it
if(NOT CMAKE_INSTALL_RPATH)
  set(CMAKE_INSTALL_RPATH "$ORIGIN/../${CMAKE_INSTALL_LIBDIR}")
endif()
add_subdirectory("${LAMMPS_SOURCE_DIR}/cmake" lammps)
include(PrecompiledHeaders)

target_include_directories(lammps PRIVATE ${FSI_SOURCE_DIRS})    # in it or not: the compiler cache then knows its objects
fsi_compile_as_lammps(fsi)
if(FSI_COMPILED_IN)
  target_sources(lammps PRIVATE $<TARGET_OBJECTS:fsi>)
  target_link_libraries(lammps PRIVATE ${FSI_FFTW} ${OpenMP_CXX_LIBRARIES})
endif()
if(FSI_COVERAGE)
  target_link_options(lammps PUBLIC --coverage)
endif()
if(FSI_SANITIZE)
  target_link_options(lammps PUBLIC -fsanitize=${FSI_SANITIZE})
endif()
