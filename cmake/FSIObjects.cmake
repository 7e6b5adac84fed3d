# The package's sources, compiled once, with the definitions and include folders of target lammps: for liblammps and the plugin.
set(FSI_SOURCE_DIRS "${CMAKE_CURRENT_SOURCE_DIR}/src/FSI" "${CMAKE_CURRENT_SOURCE_DIR}/src/FSI-CLASSIC" "${CMAKE_CURRENT_SOURCE_DIR}/src/OPENMP")
if(PKG_KOKKOS)    # in LAMMPS alone, not in the plugin: its options must be those of LAMMPS' own styles
  list(APPEND FSI_SOURCE_DIRS "${CMAKE_CURRENT_SOURCE_DIR}/src/KOKKOS")
endif()
list(TRANSFORM FSI_SOURCE_DIRS APPEND "/*.cpp" OUTPUT_VARIABLE _patterns)
file(GLOB FSI_SOURCES CONFIGURE_DEPENDS ${_patterns})
add_library(fsi OBJECT ${FSI_SOURCES})
# include folders of imported targets by -I, as in LAMMPS: then the compiler cache knows the objects of either way to build
set_target_properties(fsi PROPERTIES POSITION_INDEPENDENT_CODE ON NO_SYSTEM_FROM_IMPORTED ON)
target_compile_features(fsi PRIVATE cxx_std_17)
# what reads scripts, advises, measures, reports or stops is compiled for size: it runs before the first step, at outputs, in few
# steps or for few particles
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang" AND CMAKE_BUILD_TYPE STREQUAL "Release")
  set(_small ${FSI_SOURCES})
  set(_commands "advice|buffer|changes|check|clamps|commands|keywords|material|population|record|stop")
  set(_fixes "inlet|move|refine|report|spectrum|wall_mirror|watch")
  list(FILTER _small INCLUDE REGEX "/FSI/(atom_vec_fsi|compute_fsi_[a-z]+|fix_fsi_(${_fixes})|fsi_(${_commands}))\\.cpp$")
  set_property(SOURCE ${_small} APPEND PROPERTY COMPILE_OPTIONS -Os)
endif()
set(_instrumented ${FSI_SOURCES})
if(FSI_SANITIZE OR FSI_COVERAGE)
  # the fluid's loops are one text for all kernels, and take minutes to compile with checks in it: those of the tests' usual kernel have them
  list(FILTER _instrumented EXCLUDE REGEX "fsi_fluid_loops_cubic|fsi_fluid_loops_quintic")
endif()
set_property(SOURCE ${_instrumented} APPEND PROPERTY COMPILE_OPTIONS ${FSI_INSTRUMENT})
if(FSI_SANITIZE)
  # all that these loops call is part of them: optimised with all checks they take a quarter of an hour to compile. What the checks left out say
  # of a pointer, AddressSanitizer says where it is used; what it would say of local arrays, the check of their bounds does
  set(_loops ${FSI_SOURCES})
  list(FILTER _loops INCLUDE REGEX "fsi_fluid_rows|fsi_fluid_loops_wendland|fsi_shear|pair_fsi_solid")
  set_property(SOURCE ${_loops} APPEND PROPERTY COMPILE_OPTIONS -O0 -g0 --param=asan-stack=0 -fno-sanitize=null,vptr,pointer-overflow,object-size)
endif()
# threads of the styles in src/OPENMP: without OpenMP they have one
find_package(OpenMP COMPONENTS CXX QUIET)
if(OpenMP_CXX_FOUND)
  set(_threaded ${FSI_SOURCES})
  list(FILTER _threaded INCLUDE REGEX "/OPENMP/")
  separate_arguments(_options NATIVE_COMMAND "${OpenMP_CXX_FLAGS}")
  set_property(SOURCE ${_threaded} APPEND PROPERTY COMPILE_OPTIONS ${_options})
endif()
if(FSI_FFTW)
  target_compile_definitions(fsi PRIVATE FSI_FFTW3)
  target_include_directories(fsi PRIVATE "${FSI_FFTW_INCLUDE_DIR}")
endif()

# Compiles a target as a part of LAMMPS, without linking it: linking would be a cycle for what goes into liblammps, and a
# plugin finds LAMMPS' symbols in the process that loads it.
function(fsi_compile_as_lammps target)
  if(FSI_BUILD_LAMMPS)
    target_include_directories(${target} PRIVATE ${FSI_SOURCE_DIRS} $<TARGET_PROPERTY:lammps,INCLUDE_DIRECTORIES>)
    target_compile_definitions(${target} PRIVATE $<TARGET_PROPERTY:lammps,COMPILE_DEFINITIONS>)
    target_compile_options(${target} PRIVATE $<TARGET_PROPERTY:lammps,COMPILE_OPTIONS>)
  else()
    target_include_directories(${target} PRIVATE ${FSI_SOURCE_DIRS})
    target_link_libraries(${target} PRIVATE lammps)    # headers only
  endif()
endfunction()
