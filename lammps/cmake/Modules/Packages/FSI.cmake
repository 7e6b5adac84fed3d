# The FSI package is written in C++17. Its fix fsi/spectrum needs FFTW3 in double precision; without it this style stops with an error.
if(CMAKE_CXX_STANDARD LESS 17)
  message(FATAL_ERROR "The FSI package requires the C++ standard to be set to at least 17")
endif()
find_package(FFTW3 QUIET)
if(FFTW3_FOUND)
  set_property(SOURCE ${LAMMPS_SOURCE_DIR}/FSI/fix_fsi_spectrum.cpp APPEND PROPERTY COMPILE_DEFINITIONS FSI_FFTW3)
  target_link_libraries(lammps PRIVATE FFTW3::FFTW3)
endif()
