# Installs Parian into a folder of its own, and configures, builds and runs examples/consumer there.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}: exit status ${status}")
  endif()
endfunction()

set(folder ${BINARY}/consumer)
file(REMOVE_RECURSE ${folder})
run(${CMAKE_COMMAND} --install ${BINARY} --prefix ${folder}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/examples/consumer -B ${folder}/build -G Ninja
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${folder}/prefix)
run(${CMAKE_COMMAND} --build ${folder}/build)
run(${folder}/build/consumer ${folder}/map.h5)
# The installed program reads what the consumer wrote.
run(${folder}/prefix/bin/parian info ${folder}/map.h5)
