# Target lammps without a library: include folders and definitions, from LAMMPS' own module for plugins. LAMMPS_SIZES,
# BUILD_MPI and BUILD_OMP must be those of the LAMMPS that loads the plugin.
function(fsi_lammps_headers)
  set(LAMMPS_SOURCE_DIR "${LAMMPS_SOURCE_DIR}/src")    # as the module understands it
  include(CheckIncludeFileCXX)
  include("${LAMMPS_SOURCE_DIR}/../cmake/Modules/LAMMPSInterfacePlugin.cmake")
  target_include_directories(lammps INTERFACE "${LAMMPS_SOURCE_DIR}/RIGID")    # fsi_clamps
endfunction()
fsi_lammps_headers()
find_package(MPI QUIET)    # once more: imported targets live in the scope that found them
fsi_compile_as_lammps(fsi)
