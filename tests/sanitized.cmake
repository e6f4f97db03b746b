# Builds the modules and their tests with address and undefined-behaviour sanitizers, and runs them.
function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: exit status ${status}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --preset sanitize)
run(${CMAKE_COMMAND} --build build/sanitize --parallel 2)
run(${CMAKE_CTEST_COMMAND} --test-dir build/sanitize -L unit --parallel 2 --output-on-failure)
