# offnominal_assets(ROOM <room> ASSETS <asset>... FILES <list>): a room's web files, held inside the program.
#
# Each asset is the concatenation of the files in the variable _<asset>_files, and a function
# offnominal::desk::<room>::assets::<asset>() that gives it, declared in the room's assets.hpp. Writes
# assets.cpp in the build folder, and its dependencies for the room's target in the variable FILES.
function(offnominal_assets)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "ROOM;FILES" "ASSETS")
  set(ASSET_ROOM "${arg_ROOM}")
  set(ASSET_ASSEMBLER "")
  set(ASSET_ACCESSORS "")
  set(all_files "")
  foreach(asset IN LISTS arg_ASSETS)
    set(symbol "offnominal_${arg_ROOM}_asset_${asset}")
    set(lines "${symbol}:")
    foreach(file IN LISTS _${asset}_files)
      string(APPEND lines "\n.incbin \\\"${file}\\\"")
      list(APPEND all_files "${file}")
    endforeach()
    string(APPEND lines "\n${symbol}_end:")
    string(REPLACE "\n" "\\n\"\n    \"" lines "${lines}")
    string(APPEND ASSET_ASSEMBLER "    \"${lines}\\n\"\n")
    string(
      APPEND
      ASSET_ACCESSORS
      "extern \"C\" __attribute__((visibility(\"hidden\"))) const char ${symbol}[];\n"
      "extern \"C\" __attribute__((visibility(\"hidden\"))) const char ${symbol}_end[];\n"
      "std::string_view offnominal::desk::${arg_ROOM}::assets::${asset}() {\n"
      "  return {${symbol}, static_cast<std::size_t>(${symbol}_end - ${symbol})};\n}\n\n")
  endforeach()
  configure_file("${PROJECT_SOURCE_DIR}/cmake/assets.cpp.in" assets.cpp @ONLY)
  set(${arg_FILES} "${all_files}" PARENT_SCOPE)
endfunction()

# Those that the front end is built into lie in the build folder: they are made before. Link-time optimisation may part the assembler text from the functions that use its symbols.
function(offnominal_assets_of target files)
  set_source_files_properties(
    "${CMAKE_CURRENT_BINARY_DIR}/assets.cpp" TARGET_DIRECTORY ${target}
    PROPERTIES OBJECT_DEPENDS "${files}" COMPILE_OPTIONS "-fno-lto")
  add_dependencies(${target} offnominal_web)
endfunction()
