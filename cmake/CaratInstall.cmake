# find_package(carat [COMPONENTS core io]) for installed trees.
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/carat)
configure_package_config_file(cmake/caratConfig.cmake.in ${PROJECT_BINARY_DIR}/caratConfig.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/caratConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(EXPORT caratTargets NAMESPACE carat:: DESTINATION ${config_dir})
install(FILES ${PROJECT_BINARY_DIR}/caratConfig.cmake
              ${PROJECT_BINARY_DIR}/caratConfigVersion.cmake cmake/FindCholmod.cmake
        DESTINATION ${config_dir})
