# Finds CHOLMOD, the sparse Cholesky solver of SuiteSparse, and defines the target CHOLMOD::CHOLMOD.
# SuiteSparse before version 6 ships no CMake configuration of its own; newer ones are found the
# same way.
#
# Sets CHOLMOD_FOUND, CHOLMOD_VERSION, CHOLMOD_INCLUDE_DIR and CHOLMOD_LIBRARY.

find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse)
find_library(CHOLMOD_LIBRARY cholmod)
mark_as_advanced(CHOLMOD_INCLUDE_DIR CHOLMOD_LIBRARY)

if(CHOLMOD_INCLUDE_DIR)
  # SuiteSparse 7 moved the version into cholmod.h itself; 5 has it in cholmod_core.h.
  foreach(header IN ITEMS cholmod.h cholmod_core.h)
    if(NOT CHOLMOD_VERSION AND EXISTS "${CHOLMOD_INCLUDE_DIR}/${header}")
      file(STRINGS "${CHOLMOD_INCLUDE_DIR}/${header}" lines
           REGEX "^#define CHOLMOD_(MAIN|SUB|SUBSUB)_VERSION +[0-9]+")
      string(REGEX REPLACE "[^;0-9]*_VERSION +([0-9]+)[^;]*" "\\1" numbers "${lines}")
      list(JOIN numbers "." CHOLMOD_VERSION)
    endif()
  endforeach()
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  CHOLMOD
  REQUIRED_VARS CHOLMOD_LIBRARY CHOLMOD_INCLUDE_DIR
  VERSION_VAR CHOLMOD_VERSION)

if(CHOLMOD_FOUND AND NOT TARGET CHOLMOD::CHOLMOD)
  add_library(CHOLMOD::CHOLMOD UNKNOWN IMPORTED)
  set_target_properties(
    CHOLMOD::CHOLMOD
    PROPERTIES IMPORTED_LOCATION "${CHOLMOD_LIBRARY}"
               INTERFACE_INCLUDE_DIRECTORIES "${CHOLMOD_INCLUDE_DIR}")
endif()
