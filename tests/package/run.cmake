# run(COMMAND arguments...): runs it in the folder RUN_IN. If it fails, the test ends with what it printed;
# else that is in `output`.
set(RUN_IN ${CMAKE_CURRENT_BINARY_DIR})
function(run)
  execute_process(COMMAND ${ARGV} WORKING_DIRECTORY ${RUN_IN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "${command}\nfailed (${result}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
