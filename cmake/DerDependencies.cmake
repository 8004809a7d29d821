# Finds what the library and its program stand on, the compiler too, and says in one message what is
# missing. Tests and benchmarks take doctest-dev and libbenchmark-dev of Debian as well, the solver
# `cholmod` libsuitesparse-dev.

include(CheckLanguage)
check_language(CXX)
if(CMAKE_CXX_COMPILER)
  enable_language(CXX)
  enable_language(C) # CMake's own HDF5 finder needs it
endif()

set(der_managers "apt install" "dnf install" "brew install" "conda install -c conda-forge")
set(der_missing "")

# Notes that something is missing. `names` are its names with each of the package managers.
macro(der_note what names)
  list(APPEND der_missing "${what}")
  foreach(manager name IN ZIP_LISTS der_managers ${names})
    string(APPEND "der_line_${manager}" " ${name}")
  endforeach()
endmacro()

# Looks for a package; further arguments are those of find_package. Without a compiler CMake does not
# know where libraries are.
macro(der_find package names)
  if(CMAKE_CXX_COMPILER)
    find_package(${package} ${ARGN} QUIET)
  endif()
  if(NOT ${package}_FOUND)
    der_note(${package} ${names})
  endif()
endmacro()

set(der_compiler g++ gcc-c++ gcc cxx-compiler)
set(der_eigen libeigen3-dev eigen3-devel eigen eigen)
set(der_fmt libfmt-dev fmt-devel fmt fmt)
set(der_json nlohmann-json3-dev json-devel nlohmann-json nlohmann_json)
set(der_cli11 libcli11-dev cli11-devel cli11 cli11)
set(der_spectra libspectra-dev spectra-devel spectra spectralib) # Lanczos' method, headers only
set(der_yaml libyaml-cpp-dev yaml-cpp-devel yaml-cpp yaml-cpp)
set(der_hdf5 libhdf5-dev hdf5-devel hdf5 hdf5)
set(der_python python3-dev python3-devel python python)
if(NOT CMAKE_CXX_COMPILER)
  der_note("a C++ compiler" der_compiler)
endif()
der_find(Eigen3 der_eigen 3.4 NO_MODULE)
der_find(fmt der_fmt)
der_find(nlohmann_json der_json)
der_find(CLI11 der_cli11)
der_find(Spectra der_spectra 1.0)
der_find(yaml-cpp der_yaml)
der_find(HDF5 der_hdf5 COMPONENTS C)
if(DER_BUILD_PYTHON)
  der_find(Python der_python COMPONENTS Interpreter Development.Module)
endif()

if(der_missing)
  set(der_lines "")
  foreach(manager IN LISTS der_managers)
    string(APPEND der_lines "\n  ${manager}${der_line_${manager}}")
  endforeach()
  list(JOIN der_missing ", " der_missing)
  message(FATAL_ERROR "der is compiled here, and this is not there: ${der_missing}. Install it with one of"
                      "${der_lines}")
endif()

# yaml-cpp 0.7 names its target `yaml-cpp`, 0.8 `yaml-cpp::yaml-cpp`.
if(TARGET yaml-cpp::yaml-cpp)
  set(DER_YAML_CPP_TARGET yaml-cpp::yaml-cpp)
else()
  set(DER_YAML_CPP_TARGET yaml-cpp)
endif()

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
