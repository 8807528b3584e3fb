# cmake -DSOURCE=<checkout> -DWORK=<folder, wiped> -DGENERATOR=<name> -DCOMPILER=<of the host>
#       -DCOMMAND_FILE=<offnominal> -DCPU=<OFFNOMINAL_CPU> -P build_bare_metal.cmake
#
# Installs the headers into an empty prefix, builds tests/package/bare_metal against it with
# toolchain.cmake, and looks for a heap in what was linked.
cmake_minimum_required(VERSION 3.22)
include("${CMAKE_CURRENT_LIST_DIR}/run.cmake")

file(REMOVE_RECURSE "${WORK}")
run("${CMAKE_COMMAND}" -S "${SOURCE}" -B "${WORK}/core" -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${COMPILER}"
    -DCMAKE_BUILD_TYPE=Release -DOFFNOMINAL_BUILD_TOOLS=OFF -DOFFNOMINAL_BUILD_TESTS=OFF
    -DOFFNOMINAL_BUILD_BENCH=OFF)
run("${CMAKE_COMMAND}" --install "${WORK}/core" --prefix "${WORK}/prefix")
run("${CMAKE_COMMAND}" -S "${SOURCE}/tests/package/bare_metal" -B "${WORK}/firmware" -G "${GENERATOR}"
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_TOOLCHAIN_FILE=${SOURCE}/toolchain.cmake" "-DOFFNOMINAL_CPU=${CPU}"
    "-DCMAKE_PREFIX_PATH=${WORK}/prefix" "-DOFFNOMINAL_COMMAND=${COMMAND_FILE}"
    "-DROBOT=${SOURCE}/robots/two_link.toml")
run("${CMAKE_COMMAND}" --build "${WORK}/firmware")
run(arm-none-eabi-nm "${WORK}/firmware/firmware")
if(NOT output MATCHES " [Tt] reset\n")
  message(FATAL_ERROR "no start-up code in the firmware:\n${output}")
endif()
include("${SOURCE}/tests/gates/forbidden_symbols.cmake")
symbols_of(arm-none-eabi-nm "${WORK}/firmware/firmware" found)
list(FILTER found INCLUDE REGEX "^${forbidden_symbols}$")
if(found)
  message(FATAL_ERROR "the firmware holds ${found}")
endif()
run(arm-none-eabi-size "${WORK}/firmware/firmware")
message(STATUS "${output}")
