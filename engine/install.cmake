# cmake --install, and the packages that cpack makes of it: bris with the programs, libbris-dev for programs of others
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(BRIS_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/bris)
set(BRIS_PROGRAM_DIR ${CMAKE_INSTALL_LIBEXECDIR}/bris)   # where only the command bris looks for them

foreach(name engine systems scenarios)
  set_target_properties(bris_${name} PROPERTIES EXPORT_NAME ${name})
  add_library(bris::${name} ALIAS bris_${name})
endforeach()
foreach(room ${BRIS_ROOMS})
  add_library(bris::${room} ALIAS ${room})
endforeach()
install(TARGETS bris_engine bris_systems ${BRIS_ROOMS} bris_scenarios EXPORT bris
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/bris COMPONENT development)
install(EXPORT bris NAMESPACE bris:: DESTINATION ${BRIS_PACKAGE_DIR} FILE bris-targets.cmake COMPONENT development)
install(DIRECTORY engine components systems scenarios DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/bris
  COMPONENT development FILES_MATCHING PATTERN *.hpp PATTERN scenarios/python EXCLUDE)
configure_file(engine/bris-config.cmake.in ${PROJECT_BINARY_DIR}/bris-config.cmake @ONLY)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/bris-config-version.cmake COMPATIBILITY ExactVersion)
install(FILES ${PROJECT_BINARY_DIR}/bris-config.cmake ${PROJECT_BINARY_DIR}/bris-config-version.cmake
  engine/dependencies.cmake DESTINATION ${BRIS_PACKAGE_DIR} COMPONENT development)

function(install_programs)
  list(REMOVE_ITEM ARGN twin)            # is built only where it is asked for
  install(TARGETS ${ARGN} RUNTIME DESTINATION ${BRIS_PROGRAM_DIR} COMPONENT programs)
  install(DIRECTORY assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bris/assets COMPONENT programs
    PATTERN pictures EXCLUDE)
  if(TARGET bris)                        # the one command on the PATH
    install(TARGETS bris RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
  endif()
endfunction()

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_COMPONENTS_ALL programs development)
  set(CPACK_STRIP_FILES ON)
  set(CPACK_PACKAGE_CONTACT "the authors of BRIS")
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "discrete-element engine of railway ballast (no licence has been chosen)")
  set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME bris)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot, mosquitto")
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libbris-dev)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libtbb-dev, libeigen3-dev, libhdf5-dev, libfmt-dev, libopenvdb-dev, libboost-dev")
  if(HAS_MOSQUITTO)
    string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libmosquitto-dev")
  endif()
  if(MPI_C_FOUND)
    string(APPEND CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ", libopenmpi-dev")
  endif()
  set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/package_check.cmake)
  set(check "")
  if(BRIS_ARCH STREQUAL native)
    set(check "message(FATAL_ERROR \"expected a package for every x86-64-v3 processor (scenarios/build --preset portable), found a build for this one\")")
  endif()
  file(WRITE ${CPACK_PROJECT_CONFIG_FILE} "${check}\n")
  include(CPack)
endif()
