# The installed package: headers, static libraries, the program, data, and a CMake config with which
# find_package(parian) gives targets parian::fit, parian::io_hdf5, ... (examples/consumer uses it).
include(CMakePackageConfigHelpers)
set(PARIAN_CONFIG_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/parian)

get_property(modules GLOBAL PROPERTY PARIAN_MODULES)
install(TARGETS ${modules} EXPORT parianTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT parianTargets NAMESPACE parian:: DESTINATION ${PARIAN_CONFIG_DIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/parian
  FILES_MATCHING PATTERN "*.h" PATTERN "*_internal.h" EXCLUDE PATTERN "test_*.h" EXCLUDE
  PATTERN "app" EXCLUDE)
if(PARIAN_APP)
  install(TARGETS parian RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/parian)
endif()

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/parianConfig.cmake.in
  ${PROJECT_BINARY_DIR}/parianConfig.cmake INSTALL_DESTINATION ${PARIAN_CONFIG_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/parianConfigVersion.cmake
  VERSION ${PROJECT_VERSION} COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/parianConfig.cmake
  ${PROJECT_BINARY_DIR}/parianConfigVersion.cmake DESTINATION ${PARIAN_CONFIG_DIR})
