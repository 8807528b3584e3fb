# offnominal_embed_dbc(<file>): writes the C++ source that holds hal/offnominal.dbc, so that a log is
# read from any folder. A string literal of its length is more than compilers have to take: a line
# each.
function(offnominal_embed_dbc source)
  set(dbc "${PROJECT_SOURCE_DIR}/hal/offnominal.dbc")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${dbc}")
  file(READ "${dbc}" text)
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  string(REPLACE "\n" "\\n\",\n    \"" text "${text}")
  set(OFFNOMINAL_DBC_LINES "    \"${text}\",\n")
  configure_file("${PROJECT_SOURCE_DIR}/desk/log/offnominal_dbc.cpp.in" "${source}" @ONLY)
endfunction()
