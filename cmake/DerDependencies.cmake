# Finds what the library and its program stand on. All of it is in Debian:
# libeigen3-dev libyaml-cpp-dev libhdf5-dev libcli11-dev nlohmann-json3-dev libfmt-dev
# libspectra-dev libsuitesparse-dev, and doctest-dev, libbenchmark-dev for tests and benchmarks.

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(Spectra 1.0 REQUIRED)  # Lanczos' method, headers only

# yaml-cpp 0.7 names its target `yaml-cpp`, 0.8 `yaml-cpp::yaml-cpp`.
find_package(yaml-cpp REQUIRED)
if(TARGET yaml-cpp::yaml-cpp)
  set(DER_YAML_CPP_TARGET yaml-cpp::yaml-cpp)
else()
  set(DER_YAML_CPP_TARGET yaml-cpp)
endif()

find_package(HDF5 REQUIRED COMPONENTS C)

if(NOT DER_WITH_CHOLMOD MATCHES "^(AUTO|ON|OFF)$")
  message(FATAL_ERROR "DER_WITH_CHOLMOD is '${DER_WITH_CHOLMOD}'; use AUTO, ON or OFF")
endif()
set(DER_HAS_CHOLMOD FALSE)
if(DER_WITH_CHOLMOD STREQUAL "ON")
  find_package(CHOLMOD REQUIRED)
  set(DER_HAS_CHOLMOD TRUE)
elseif(DER_WITH_CHOLMOD STREQUAL "AUTO")
  find_package(CHOLMOD)
  set(DER_HAS_CHOLMOD ${CHOLMOD_FOUND})
endif()
