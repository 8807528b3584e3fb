# run(<command>...): stops with its output where it fails; otherwise leaves that in `output`.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE outcome OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(NOT outcome EQUAL 0)
    string(REPLACE ";" " " command "${ARGV}")
    message(FATAL_ERROR "${command}\n${text}")
  endif()
  set(output "${text}" PARENT_SCOPE)
endfunction()
