# find_package(carat [COMPONENTS core io distributed]) for installed trees, which can be moved as a whole.
include(CMakePackageConfigHelpers)
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/carat)
list(JOIN vtk_components " " CARAT_VTK_COMPONENTS)
configure_package_config_file(cmake/caratConfig.cmake.in ${PROJECT_BINARY_DIR}/caratConfig.cmake
                              INSTALL_DESTINATION ${config_dir} NO_CHECK_REQUIRED_COMPONENTS_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/caratConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/caratConfig.cmake
              ${PROJECT_BINARY_DIR}/caratConfigVersion.cmake
        DESTINATION ${config_dir})
if(CARAT_WITH_CHOLMOD)
  install(FILES cmake/FindCholmod.cmake DESTINATION ${config_dir})
endif()

install(TARGETS carat_core EXPORT caratCoreTargets FILE_SET HEADERS)
install(EXPORT caratCoreTargets NAMESPACE carat:: DESTINATION ${config_dir})
if(CARAT_BUILD_IO)
  install(TARGETS carat_io carat_viewer EXPORT caratIoTargets FILE_SET HEADERS)
  install(EXPORT caratIoTargets NAMESPACE carat:: DESTINATION ${config_dir})
endif()
if(CARAT_HAS_DISTRIBUTED)
  install(TARGETS carat_distributed carat_partition carat_parts EXPORT caratDistributedTargets
          FILE_SET HEADERS)
  install(EXPORT caratDistributedTargets NAMESPACE carat:: DESTINATION ${config_dir})
  install(FILES cmake/FindScotch.cmake DESTINATION ${config_dir})
endif()
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
