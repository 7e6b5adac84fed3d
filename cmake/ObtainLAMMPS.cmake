# Finds the LAMMPS source tree: the user's own (-DLAMMPS_SOURCE_DIR=<tree>), or a release that
# cmake/obtain-lammps.sh downloads once into a cache folder and verifies by SHA-256.
set(LAMMPS_SOURCE_DIR "" CACHE PATH "LAMMPS source tree (empty: obtain FSI_LAMMPS_RELEASE)")
set(FSI_LAMMPS_RELEASE 20250204 CACHE STRING "LAMMPS release to obtain: 20250204 or 20260704")
if(DEFINED ENV{XDG_CACHE_HOME})
  set(_fsi_cache "$ENV{XDG_CACHE_HOME}/lammps-fsi")
else()
  set(_fsi_cache "$ENV{HOME}/.cache/lammps-fsi")
endif()
set(FSI_LAMMPS_CACHE "${_fsi_cache}" CACHE PATH "Where the obtained LAMMPS tree is kept")

if(NOT LAMMPS_SOURCE_DIR)
  execute_process(
    COMMAND "${CMAKE_CURRENT_LIST_DIR}/obtain-lammps.sh" "${FSI_LAMMPS_CACHE}" "${FSI_LAMMPS_RELEASE}"
    RESULT_VARIABLE _result
    OUTPUT_VARIABLE _tree OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(NOT _result EQUAL 0)
    message(FATAL_ERROR
      "Could not obtain the LAMMPS sources (the reason is printed above).\n"
      "Download a LAMMPS release (4 Feb 2025 or newer), unpack it, and configure again with\n"
      "  cmake -DLAMMPS_SOURCE_DIR=<the unpacked folder> ...")
  endif()
  set(LAMMPS_SOURCE_DIR "${_tree}" CACHE PATH "LAMMPS source tree (empty: obtain FSI_LAMMPS_RELEASE)" FORCE)
endif()

get_filename_component(LAMMPS_SOURCE_DIR "${LAMMPS_SOURCE_DIR}" ABSOLUTE)
if(NOT EXISTS "${LAMMPS_SOURCE_DIR}/cmake/CMakeLists.txt" OR NOT EXISTS "${LAMMPS_SOURCE_DIR}/src/lammps.cpp")
  message(FATAL_ERROR
    "LAMMPS_SOURCE_DIR='${LAMMPS_SOURCE_DIR}' is not a LAMMPS source tree: it has no cmake/CMakeLists.txt and "
    "src/lammps.cpp. Point -DLAMMPS_SOURCE_DIR at the top folder of an unpacked LAMMPS release.")
endif()
file(STRINGS "${LAMMPS_SOURCE_DIR}/src/version.h" _version REGEX "LAMMPS_VERSION")
message(STATUS "LAMMPS sources: ${LAMMPS_SOURCE_DIR} ${_version}")
