# FFTW3 in double precision, for fix fsi/spectrum alone: FSI_FFTW is its library, or empty; then the style
# says what is missing.
find_path(FSI_FFTW_INCLUDE_DIR fftw3.h)
find_library(FSI_FFTW_LIBRARY fftw3)
mark_as_advanced(FSI_FFTW_INCLUDE_DIR FSI_FFTW_LIBRARY)
if(FSI_FFTW_INCLUDE_DIR AND FSI_FFTW_LIBRARY)
  set(FSI_FFTW "${FSI_FFTW_LIBRARY}")
  message(STATUS "FFTW3: ${FSI_FFTW}")
else()
  set(FSI_FFTW "")
  message(STATUS "FFTW3 was not found (Debian: libfftw3-dev): fix fsi/spectrum will not work")
endif()
