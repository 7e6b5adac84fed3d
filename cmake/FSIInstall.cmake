# Beside what LAMMPS installs: materials, the plugin, and a script for the shell that says where they are.
install(DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/potentials/" DESTINATION ${CMAKE_INSTALL_DATADIR}/lammps/potentials
        FILES_MATCHING PATTERN "*.fsi")
install(TARGETS fsiplugin LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/lammps/plugins)

# LAMMPS built here is put on the PATH; for one that was there before, the plugin is loaded when it starts
if(FSI_COMPILED_IN)
  set(_where "PATH=\\\"\${prefix}/${CMAKE_INSTALL_BINDIR}:$PATH\\\"; export PATH")
else()
  set(_where "LAMMPS_PLUGIN_PATH=\\\"\${prefix}/${CMAKE_INSTALL_LIBDIR}/lammps/plugins\\\"; export LAMMPS_PLUGIN_PATH")
endif()
# written when it is installed: only then is the prefix known (cmake --install --prefix)
install(CODE "
  get_filename_component(prefix \"\${CMAKE_INSTALL_PREFIX}\" ABSOLUTE)
  file(WRITE \"\$ENV{DESTDIR}\${prefix}/etc/profile.d/lammps-fsi.sh\"
    \"# . this file, in a Bourne shell\\n${_where}\\nLAMMPS_POTENTIALS=\\\"\${prefix}/${CMAKE_INSTALL_DATADIR}/lammps/potentials\\\"; export LAMMPS_POTENTIALS\\n\")
")
