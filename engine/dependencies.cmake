# Finds what BRIS is made of, and names in one line all that is missing or too old. Versions are compared here, because
# find_package takes 3.4 for "before 4". Programs that use an installed BRIS include this, too, without BRIS_BUILDS.
set(BRIS_LACKS "")
macro(bris_require found name version least package)
  if(NOT ${found})
    list(APPEND BRIS_LACKS "${name} ${least} (${package})")
  elseif("${version}" VERSION_LESS "${least}")
    list(APPEND BRIS_LACKS "${name} ${least} (${package}; found ${version})")
  endif()
endmacro()

find_package(Threads REQUIRED)
find_package(TBB CONFIG QUIET COMPONENTS tbb)          # CONFIG: OpenVDB ships an old FindTBB
bris_require(TBB_FOUND oneTBB "${TBB_VERSION}" 2021 libtbb-dev)
find_package(Eigen3 CONFIG QUIET)
bris_require(Eigen3_FOUND Eigen "${Eigen3_VERSION}" 3.4 libeigen3-dev)
set(HDF5_PREFER_PARALLEL OFF)
find_package(HDF5 QUIET COMPONENTS C)
bris_require(HDF5_FOUND HDF5 "${HDF5_VERSION}" 1.10 libhdf5-dev)
find_package(fmt CONFIG QUIET)
bris_require(fmt_FOUND fmt "${fmt_VERSION}" 9 libfmt-dev)

find_package(Imath CONFIG QUIET)         # of an OpenVDB that was built with it
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)       # Debian's FindOpenVDB asks for a missing package
find_library(OPENVDB_LIBRARY openvdb)
set(OPENVDB_VERSION "")
if(OPENVDB_INCLUDE_DIR AND OPENVDB_LIBRARY)
  file(STRINGS ${OPENVDB_INCLUDE_DIR}/openvdb/version.h OPENVDB_VERSION
    REGEX "define OPENVDB_LIBRARY_(MAJOR|MINOR|PATCH)_VERSION_NUMBER +[0-9]")
  list(TRANSFORM OPENVDB_VERSION REPLACE "[^0-9]" "")
  list(JOIN OPENVDB_VERSION . OPENVDB_VERSION)
endif()
bris_require(OPENVDB_VERSION OpenVDB "${OPENVDB_VERSION}" 10 libopenvdb-dev)
if(OPENVDB_VERSION AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES IMPORTED_LOCATION ${OPENVDB_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OPENVDB_INCLUDE_DIR}
    INTERFACE_LINK_LIBRARIES "$<TARGET_NAME_IF_EXISTS:Imath::Imath>;TBB::tbb")
endif()

# Broker of live recordings: without it everything else is built, and --broker says so
if(BRIS_BROKER)
  find_path(MOSQUITTO_INCLUDE_DIR mosquitto.h)
  find_library(MOSQUITTO_LIBRARY mosquitto)
endif()
set(HAS_MOSQUITTO OFF)
if(BRIS_BROKER AND MOSQUITTO_INCLUDE_DIR AND MOSQUITTO_LIBRARY)
  set(HAS_MOSQUITTO ON)
  set(MOSQUITTO_HEADER ${MOSQUITTO_INCLUDE_DIR}/mosquitto/libmosquitto.h)   # since 2.1
  if(NOT EXISTS ${MOSQUITTO_HEADER})
    set(MOSQUITTO_HEADER ${MOSQUITTO_INCLUDE_DIR}/mosquitto.h)
  endif()
  file(STRINGS ${MOSQUITTO_HEADER} MOSQUITTO_VERSION REGEX "define LIBMOSQUITTO_(MAJOR|MINOR|REVISION)")
  list(TRANSFORM MOSQUITTO_VERSION REPLACE "[^0-9]" "")
  list(JOIN MOSQUITTO_VERSION . MOSQUITTO_VERSION)
  bris_require(MOSQUITTO_VERSION mosquitto "${MOSQUITTO_VERSION}" 2.0 libmosquitto-dev)
  if(NOT TARGET mosquitto::client)
    add_library(mosquitto::client UNKNOWN IMPORTED)
    set_target_properties(mosquitto::client PROPERTIES IMPORTED_LOCATION ${MOSQUITTO_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${MOSQUITTO_INCLUDE_DIR})
  endif()
endif()
# Runs on several ranks: without MPI everything else is built, and --ranks says so
if(BRIS_MPI AND NOT BRIS_SANITIZE)
  find_package(MPI QUIET COMPONENTS C)
endif()

if(BRIS_BUILDS)
  find_package(Boost CONFIG QUIET)       # headers: special functions, and those of OpenVDB
  bris_require(Boost_FOUND Boost "${Boost_VERSION}" 1.74 libboost-dev)
  find_package(nanoflann CONFIG QUIET)
  bris_require(nanoflann_FOUND nanoflann "${nanoflann_VERSION}" 1.4 libnanoflann-dev)
  find_package(nlohmann_json CONFIG QUIET)
  bris_require(nlohmann_json_FOUND nlohmann-json "${nlohmann_json_VERSION}" 3.11 nlohmann-json3-dev)
endif()
if(BRIS_TESTS)
  find_package(doctest CONFIG QUIET)
  bris_require(doctest_FOUND doctest "${doctest_VERSION}" 2.4 doctest-dev)
endif()
if(BRIS_LACKS)
  list(JOIN BRIS_LACKS ", " BRIS_LACKS)
  message(NOTICE "BRIS needs ${BRIS_LACKS}")
  message(FATAL_ERROR "Each with the least version (and Debian's package).")
endif()
