# fsiplugin.so: the package for a LAMMPS of the same release, through "plugin load" or LAMMPS_PLUGIN_PATH (*plugin.so).
add_library(fsiplugin MODULE "${CMAKE_CURRENT_SOURCE_DIR}/src/PLUGIN/fsiplugin.cpp" $<TARGET_OBJECTS:fsi>)
set_target_properties(fsiplugin PROPERTIES PREFIX "" SUFFIX ".so" LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}"
                      INSTALL_RPATH "")
target_compile_features(fsiplugin PRIVATE cxx_std_17)
target_compile_options(fsiplugin PRIVATE ${FSI_INSTRUMENT})
fsi_compile_as_lammps(fsiplugin)
if(APPLE)
  target_link_options(fsiplugin PRIVATE "LINKER:-undefined,dynamic_lookup")
else()
  # the atom style's code must stay when LAMMPS unloads the other styles
  target_link_options(fsiplugin PRIVATE "LINKER:-z,nodelete")
endif()
if(FSI_COVERAGE)
  target_link_options(fsiplugin PRIVATE --coverage)
endif()
if(FSI_SANITIZE)
  target_link_options(fsiplugin PRIVATE -fsanitize=${FSI_SANITIZE})
endif()
