# cmake -DWAY=find_package|add_subdirectory -DSOURCE=<checkout> -DWORK=<folder, wiped> ...
#
# Installs the headers into an empty prefix as a firmware project would (no tools, no tests), then
# builds and runs tests/package/foreign against it; or adds the checkout to it as a subfolder. With
# -DCOMMAND_FILE=<offnominal> also its joint controller, whose model that command writes.
cmake_minimum_required(VERSION 3.22)

include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

# Either way with the build type that the other has not.
if(WAY STREQUAL "find_package")
  set(build_type Release)
else()
  set(build_type Debug)
endif()
set(common -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${COMPILER}" "-DCMAKE_BUILD_TYPE=${build_type}")
file(REMOVE_RECURSE "${WORK}")

if(WAY STREQUAL "find_package")
  run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${WORK}/core" ${common} -DOFFNOMINAL_BUILD_TOOLS=OFF
      -DOFFNOMINAL_BUILD_TESTS=OFF -DOFFNOMINAL_BUILD_BENCH=OFF)
  run("${CMAKE_COMMAND}" --build "${WORK}/core")
  run("${CMAKE_COMMAND}" --install "${WORK}/core" --prefix "${WORK}/prefix")
  set(where "-DCMAKE_PREFIX_PATH=${WORK}/prefix")
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

# The package must have been found where it was put, not somewhere on the machine.
if(WAY STREQUAL "find_package")
  file(STRINGS "${WORK}/foreign/CMakeCache.txt" found REGEX "^offnominal_DIR:")
  string(FIND "${found}" "${WORK}/prefix/" at)
  if(at EQUAL -1)
    message(FATAL_ERROR "found another offnominal: ${found}")
  endif()
endif()
