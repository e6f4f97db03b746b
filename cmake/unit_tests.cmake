# One test program per module from the *_test.cpp beside its sources, at -O1 in release builds
# (compile time), with one precompiled GoogleTest header for all of them.
include(GoogleTest)
add_library(parian_test_pch OBJECT ${PROJECT_SOURCE_DIR}/cmake/test_pch.cpp)
target_precompile_headers(parian_test_pch PRIVATE <gtest/gtest.h> <gmock/gmock.h>)
target_link_libraries(parian_test_pch PRIVATE parian_flags GTest::gtest GTest::gmock)
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(parian_test_pch PRIVATE -O1)
endif()

get_property(modules GLOBAL PROPERTY PARIAN_TESTED_MODULES)
foreach(module IN LISTS modules)
  get_property(sources GLOBAL PROPERTY PARIAN_TESTS_${module})
  add_executable(test_${module} ${sources})
  target_link_libraries(test_${module} PRIVATE parian_${module} parian_flags Eigen3::Eigen GTest::gtest GTest::gmock GTest::gmock_main)
  target_precompile_headers(test_${module} REUSE_FROM parian_test_pch)
  target_compile_definitions(test_${module} PRIVATE PARIAN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(test_${module} PRIVATE -O1)
  endif()
  gtest_discover_tests(test_${module} TEST_PREFIX "${module}." DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS unit TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endforeach()
if(TARGET test_studio)
  gtest_discover_tests(test_studio TEST_PREFIX "studio." DISCOVERY_MODE PRE_TEST
    PROPERTIES LABELS unit TIMEOUT 300 DISCOVERY_TIMEOUT 60)
endif()
