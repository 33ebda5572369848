# Finds the netCDF C library by its header and library. Debian's own package file names the static libraries of HDF5's
# dependencies, which a program that links the shared library does not need.
find_path(NetCDF_INCLUDE_DIR netcdf.h)
find_library(NetCDF_LIBRARY netcdf)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(NetCDF REQUIRED_VARS NetCDF_LIBRARY NetCDF_INCLUDE_DIR)
if(NetCDF_FOUND AND NOT TARGET NetCDF::C)
  add_library(NetCDF::C UNKNOWN IMPORTED)
  set_target_properties(NetCDF::C PROPERTIES IMPORTED_LOCATION "${NetCDF_LIBRARY}"
                                             INTERFACE_INCLUDE_DIRECTORIES "${NetCDF_INCLUDE_DIR}")
endif()
mark_as_advanced(NetCDF_INCLUDE_DIR NetCDF_LIBRARY)
