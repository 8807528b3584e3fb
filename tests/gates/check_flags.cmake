# cmake -DCOMPILER=<c++> -DFLAGS=<flags> -DROOT=<checkout> -DEIGEN=<folder> -DWORK=<folder> [-DREFUSED=ON]
#       -P check_flags.cmake
#
# Compiles flags.cpp with these flags and runs it. With REFUSED it has to be refused by the headers'
# own words instead.
cmake_minimum_required(VERSION 3.22)

separate_arguments(flags UNIX_COMMAND "${FLAGS}")
set(includes "-I${ROOT}/core/include" "-I${ROOT}/core/joint_count" "-I${ROOT}/hal/include" "-I${ROOT}/targets/include" -isystem "${EIGEN}")
file(MAKE_DIRECTORY "${WORK}")
execute_process(
  COMMAND ${LAUNCHER} "${COMPILER}" -std=c++20 -O2 -DNDEBUG -Wfatal-errors ${flags} ${includes} -c
          "${ROOT}/tests/gates/flags.cpp" -o "${WORK}/flags.o"
  RESULT_VARIABLE outcome ERROR_VARIABLE complaint)
if(REFUSED)
  if(outcome EQUAL 0 OR NOT complaint MATCHES "offnominal: not with -ffast-math")
    message(FATAL_ERROR "${COMPILER} ${FLAGS}: not refused by the headers (${outcome})\n${complaint}")
  endif()
  return()
endif()
if(NOT outcome EQUAL 0)
  message(FATAL_ERROR "${COMPILER} ${FLAGS}: does not compile\n${complaint}")
endif()
# Without the flags: they would link start-up code that sets the processor's mode.
execute_process(COMMAND "${COMPILER}" "${WORK}/flags.o" -o "${WORK}/flags" COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${WORK}/flags" RESULT_VARIABLE outcome OUTPUT_VARIABLE found)
if(NOT outcome EQUAL 0)
  message(FATAL_ERROR "${COMPILER} ${FLAGS}: (${outcome})\n${found}")
endif()
