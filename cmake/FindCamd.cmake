# Finds CAMD of SuiteSparse (BSD-3-Clause): the constrained minimum-degree ordering. SuiteSparse 5 has no CMake package.
find_path(Camd_INCLUDE_DIR camd.h PATH_SUFFIXES suitesparse)
find_library(Camd_LIBRARY camd)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Camd REQUIRED_VARS Camd_LIBRARY Camd_INCLUDE_DIR)
if(Camd_FOUND AND NOT TARGET Camd::Camd)
  add_library(Camd::Camd UNKNOWN IMPORTED)
  set_target_properties(Camd::Camd PROPERTIES IMPORTED_LOCATION "${Camd_LIBRARY}"
                                              INTERFACE_INCLUDE_DIRECTORIES "${Camd_INCLUDE_DIR}")
endif()
mark_as_advanced(Camd_INCLUDE_DIR Camd_LIBRARY)
