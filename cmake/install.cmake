include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/rubato)
install(TARGETS rubato EXPORT rubato-targets FILE_SET HEADERS)
install(EXPORT rubato-targets NAMESPACE rubato:: DESTINATION ${package_dir})
# Who links a static library links what it uses as well.
get_target_property(rubato_library_type rubato TYPE)
configure_package_config_file(cmake/rubato-config.cmake.in rubato-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(rubato-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rubato-config.cmake ${PROJECT_BINARY_DIR}/rubato-config-version.cmake
              cmake/FindNetCDF.cmake cmake/FindCamd.cmake
        DESTINATION ${package_dir})
