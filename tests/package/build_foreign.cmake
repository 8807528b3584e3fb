# cmake -DWAY=find_package|add_subdirectory -DSOURCE=<checkout> -DWORK=<folder, wiped> -DLINUX=ON|OFF ...
#
# Installs the headers into an empty prefix as a firmware project would (no tools, no tests), then
# builds and runs tests/package/foreign against it; or adds the checkout to it as a subfolder. With
# -DCOMMAND_FILE=<offnominal> also its joint controller, whose model that command writes. -DLINUX=ON:
# with the libraries for Linux, and every installed header is compiled by itself. Either way what is
# installed is checked: no header without its target.
cmake_minimum_required(VERSION 3.22)

include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

# Optimised once: it takes minutes, and the headers are the same.
if(WAY STREQUAL "find_package" AND LINUX)
  set(build_type Release)
else()
  set(build_type Debug)
endif()
set(common -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_BUILD_TYPE=${build_type}")
file(REMOVE_RECURSE "${WORK}")

if(WAY STREQUAL "find_package")
  run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${WORK}/core" ${common} -DOFFNOMINAL_BUILD_TOOLS=OFF
      -DOFFNOMINAL_BUILD_TESTS=OFF -DOFFNOMINAL_BUILD_BENCH=OFF -DOFFNOMINAL_BUILD_LINUX=${LINUX})
  run("${CMAKE_COMMAND}" --build "${WORK}/core")
  run("${CMAKE_COMMAND}" --install "${WORK}/core" --prefix "${WORK}/prefix")
  set(where "-DCMAKE_PREFIX_PATH=${WORK}/prefix")
  include("${CMAKE_CURRENT_LIST_DIR}/installed.cmake")
  check_installed("${WORK}/prefix" "${SOURCE}")
  if(COMMAND_FILE AND LINUX)
    file(WRITE "${WORK}/installed.cmake"
         "set(_installed_headers \"${headers}\")\nset(_installed_targets \"${targets}\")\n")
    list(APPEND where "-DINSTALLED=${WORK}/installed.cmake")
  endif()
else()
  set(where "-DOFFNOMINAL_FOLDER=${SOURCE}")
endif()

set(model)
if(COMMAND_FILE)
  set(model "-DOFFNOMINAL_COMMAND=${COMMAND_FILE}" "-DROBOT=${SOURCE}/robots/two_link.toml")
endif()
run("${CMAKE_COMMAND}" -S "${SOURCE}/tests/package/foreign" -B "${WORK}/foreign" ${common} ${where} ${model})
run("${CMAKE_COMMAND}" --build "${WORK}/foreign")
run("${WORK}/foreign/firmware")
message(STATUS "${output}")
if(NOT output MATCHES "offnominal ${VERSION}: fault after")
  message(FATAL_ERROR "expected the words `offnominal ${VERSION}: fault after`")
endif()

if(COMMAND_FILE)
  run("${WORK}/foreign/controller")
  message(STATUS "${output}")
  if(NOT output MATCHES "joint1 is held with 44.1")
    message(FATAL_ERROR "expected the words `joint1 is held with 44.1`")
  endif()
endif()

# As a subfolder the headers alone, unless asked for.
if(WAY STREQUAL "find_package" AND LINUX)
  run("${WORK}/foreign/on_linux")
  if(NOT output MATCHES "a tick on Linux")
    message(FATAL_ERROR "expected the words `a tick on Linux`, found ${output}")
  endif()
endif()

# The package must have been found where it was put, not somewhere on the machine.
if(WAY STREQUAL "find_package")
  file(STRINGS "${WORK}/foreign/CMakeCache.txt" found REGEX "^offnominal_DIR:")
  string(FIND "${found}" "${WORK}/prefix/" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "found another offnominal: ${found}")
  endif()
endif()
