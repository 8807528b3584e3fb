# cmake -DNM=<nm> "-DOBJECTS=<file>;..." [-DEXPECTED=<symbol>] -P check_listens.cmake
#
# Fails when one of the objects asks for a call of the system that writes, or for hal::SocketCan, which has
# one. With EXPECTED it is a control: it fails unless that symbol is among those found.
cmake_minimum_required(VERSION 3.22)

include("${CMAKE_CURRENT_LIST_DIR}/forbidden_symbols.cmake")
set(writing "(send|sendto|sendmsg|sendmmsg|write|writev|pwrite|pwrite64|pwritev|sendfile|splice|fwrite|io_uring[^ ]*|_ZNK?[^ ]*9SocketCan[^ ]*)")
set(found "")
foreach(object IN LISTS OBJECTS)
  symbols_of("${NM}" "${object}" undefined --undefined-only)
  if(NOT undefined)
    message(FATAL_ERROR "${object}: asks for nothing, so there is nothing to judge")
  endif()
  list(FILTER undefined INCLUDE REGEX "^${writing}$")
  list(APPEND found ${undefined})
endforeach()
message(STATUS "found: ${found}")
if(DEFINED EXPECTED)
  if(NOT EXPECTED IN_LIST found)
    message(FATAL_ERROR "the gate did not find ${EXPECTED}: it could not fail")
  endif()
elseif(found)
  message(FATAL_ERROR "what listens to a bus asks for ${found}")
endif()
