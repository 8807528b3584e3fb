# offnominal_room(NAME <room> SOURCES <file>... [USES <room>...] [PUBLIC <library>...] [PRIVATE <library>...])
#
# A room of the desk: the folder's sources as a static library desk_<room>. Headers are included as
# "<room>/<header>.hpp". USES: the rooms whose headers its files include, every one of them and no other;
# gates.rooms compares. Arrows run one way: rooms that use each other are refused here, and whatever is not
# used is not linked, which the tests of each room would miss.
set_property(GLOBAL PROPERTY GLOBAL_DEPENDS_NO_CYCLES ON)

function(offnominal_room)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "NAME" "SOURCES;USES;PUBLIC;PRIVATE")
  if(NOT arg_NAME OR NOT arg_SOURCES OR arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "offnominal_room: NAME and SOURCES are required; not understood: ${arg_UNPARSED_ARGUMENTS}")
  endif()
  set(used "")
  foreach(room IN LISTS arg_USES)
    if(NOT TARGET desk_${room})
      message(FATAL_ERROR "offnominal_room(${arg_NAME}): uses ${room}, which is not below it; "
                          "the order of desk/CMakeLists.txt is from the ground up")
    endif()
    list(APPEND used desk_${room})
  endforeach()
  add_library(desk_${arg_NAME} STATIC ${arg_SOURCES})
  target_include_directories(desk_${arg_NAME} PUBLIC "${PROJECT_SOURCE_DIR}/desk")
  target_link_libraries(
    desk_${arg_NAME}
    PUBLIC offnominal::core ${used} ${arg_PUBLIC}
    PRIVATE offnominal_warnings ${arg_PRIVATE})
  list(JOIN arg_USES " " uses)
  set_property(GLOBAL APPEND PROPERTY OFFNOMINAL_ROOMS "${arg_NAME}:${uses}")
endfunction()
