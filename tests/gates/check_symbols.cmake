# cmake -DNM=<nm> -DOBJECT=<file> [-DEXPECTED=<symbol>] -P check_symbols.cmake
#
# Fails when the object asks for a symbol of the heap, of exceptions or of guarded statics. With
# EXPECTED it is a control: it fails unless that symbol is among those found.
cmake_minimum_required(VERSION 3.22)

set(forbidden
    "^(malloc|free|calloc|realloc|posix_memalign|aligned_alloc|memalign|valloc)$"
    "^_Zn[wa]" # operator new
    "^_Zd[la]" # operator delete
    "^__cxa_(throw|rethrow|allocate_exception|bad_cast|bad_typeid|guard_.*|atexit)"
    "^_ZSt.*throw"
    "^(_Unwind_|__gxx_personality)")

execute_process(
  COMMAND "${NM}" --undefined-only --format=posix "${OBJECT}"
  OUTPUT_VARIABLE text
  RESULT_VARIABLE outcome
  ERROR_VARIABLE complaint)
if(NOT outcome EQUAL 0)
  message(FATAL_ERROR "${NM} ${OBJECT}: ${complaint}")
endif()

string(REGEX MATCHALL "[^\n]+" lines "${text}")
set(undefined)
set(found)
foreach(line IN LISTS lines)
  string(REGEX REPLACE " .*" "" symbol "${line}")
  list(APPEND undefined "${symbol}")
  foreach(pattern IN LISTS forbidden)
    if(symbol MATCHES "${pattern}")
      list(APPEND found "${symbol}")
      break()
    endif()
  endforeach()
endforeach()

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
