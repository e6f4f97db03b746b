# Test programs, at -O1 in release builds (compile time), with one precompiled GoogleTest header for
# all of them.
include(GoogleTest)
add_library(parian_test_pch OBJECT ${PROJECT_SOURCE_DIR}/cmake/test_pch.cpp)
target_precompile_headers(parian_test_pch PRIVATE <gtest/gtest.h> <gmock/gmock.h>)
target_link_libraries(parian_test_pch PRIVATE parian_flags GTest::gtest GTest::gmock)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(parian_test_pch PRIVATE -O1)
endif()

# parian_test(<name> [PREFIX <of its tests in ctest, <name> by default>] SOURCES <...> LINK <...>):
# the program test_<name>.
function(parian_test name)
  cmake_parse_arguments(ARG "" "PREFIX" "SOURCES;LINK" ${ARGN})
  if(NOT ARG_PREFIX)
    set(ARG_PREFIX ${name})
  endif()
  add_executable(test_${name} ${ARG_SOURCES})
  target_link_libraries(test_${name} PRIVATE ${ARG_LINK} parian_flags GTest::gtest GTest::gmock
    GTest::gmock_main)
  target_precompile_headers(test_${name} REUSE_FROM parian_test_pch)
  target_compile_definitions(test_${name} PRIVATE PARIAN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(test_${name} PRIVATE -O1)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX "${ARG_PREFIX}." DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS unit TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endfunction()

# One program per module, from the *_test.cpp beside its sources.
function(parian_module_tests)
  get_property(modules GLOBAL PROPERTY PARIAN_TESTED_MODULES)
  foreach(module IN LISTS modules)
    get_property(sources GLOBAL PROPERTY PARIAN_TESTS_${module})
    parian_test(${module} SOURCES ${sources} LINK parian_${module} Eigen3::Eigen)
  endforeach()
endfunction()
