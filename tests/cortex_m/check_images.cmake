# cmake -DFOLDER=<build folder of targets/cortex_m> -P check_images.cmake
# cmake -DNM=<nm> -DIMAGE=<program> -DEXPECTED=<symbol> -P check_images.cmake
#
# Fails when a firmware image, or its map, holds anything of a heap, of exceptions, of RTTI or of
# guarded statics. With EXPECTED it is a control: it fails unless that symbol is found.
cmake_minimum_required(VERSION 3.22)

include("${CMAKE_CURRENT_LIST_DIR}/../gates/forbidden_symbols.cmake")
set(forbidden "(${forbidden_symbols}|_ZTI[^ ()\n]*)") # and RTTI

# forbidden_in(<image> <variable>): the symbols of the image that must not be there.
function(forbidden_in image variable)
  symbols_of("${NM}" "${image}" symbols)
  list(LENGTH symbols count)
  if(count LESS 20)
    message(FATAL_ERROR "${image}: ${count} symbols, so there is nothing to judge")
  endif()
  list(FILTER symbols INCLUDE REGEX "^${forbidden}$")
  set(${variable} "${symbols}" PARENT_SCOPE)
endfunction()

if(DEFINED EXPECTED)
  forbidden_in("${IMAGE}" found)
  if(NOT EXPECTED IN_LIST found)
    message(FATAL_ERROR "the check did not find ${EXPECTED} in ${IMAGE}: it could not fail")
  endif()
  return()
endif()

set(NM arm-none-eabi-nm)
file(GLOB images "${FOLDER}/*.elf")
list(LENGTH images image_count)
if(image_count LESS 4)
  message(FATAL_ERROR "${FOLDER}: ${image_count} images; ./dev firmware builds them")
endif()
foreach(image IN LISTS images)
  forbidden_in("${image}" found)
  if(EXISTS "${image}.map")
    file(READ "${image}.map" map)
    # Sections of functions and where archives' members were asked for by name.
    if(map MATCHES "[ .(]${forbidden}[)\n]")
      list(APPEND found "in the map: ${CMAKE_MATCH_1}")
    endif()
  endif()
  if(found)
    message(FATAL_ERROR "${image} holds ${found}")
  endif()
endforeach()
message(STATUS "${image_count} images without heap, exceptions, RTTI and guarded statics")
