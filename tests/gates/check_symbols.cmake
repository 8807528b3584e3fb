# cmake -DNM=<nm> -DOBJECT=<file> [-DEXPECTED=<symbol>] -P check_symbols.cmake
#
# Fails when the object asks for a symbol of the heap, of exceptions or of guarded statics. With
# EXPECTED it is a control: it fails unless that symbol is among those found.
cmake_minimum_required(VERSION 3.22)

include("${CMAKE_CURRENT_LIST_DIR}/forbidden_symbols.cmake")
symbols_of("${NM}" "${OBJECT}" undefined --undefined-only)
set(found ${undefined})
list(FILTER found INCLUDE REGEX "^${forbidden_symbols}$")

# An object with nothing in it would pass every gate.
execute_process(COMMAND "${NM}" --defined-only --format=posix "${OBJECT}" OUTPUT_VARIABLE defined)
string(REGEX MATCHALL " [TW] " functions "${defined}")
list(LENGTH functions function_count)
if(function_count EQUAL 0)
  message(FATAL_ERROR "${OBJECT}: defines no function, so there is nothing to judge")
endif()

string(REPLACE ";" " " undefined "${undefined}")
string(REPLACE ";" " " found_text "${found}")
message(STATUS "${OBJECT}: ${function_count} functions, which ask for: ${undefined}")
message(STATUS "forbidden among them: ${found_text}")

if(DEFINED EXPECTED)
  if(NOT EXPECTED IN_LIST found)
    message(FATAL_ERROR "the gate did not find ${EXPECTED}: it could not fail")
  endif()
elseif(found)
  message(FATAL_ERROR "core asks for ${found_text}")
endif()
