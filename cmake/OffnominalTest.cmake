find_package(GTest REQUIRED)
include(GoogleTest)

# offnominal_add_test(NAME <target> SOURCES <file>... [LIBRARIES <target>...] [LABELS <label>]
#                     [TOGETHER | BUS | REAL_TIME] [LONG] [AS_SHIPPED] [THREADS] [UNWATCHED])
#
# Builds one GoogleTest executable and registers each of its cases with CTest, or with TOGETHER all of
# them as one test: for cases that share what takes long to compute. Where the sanitizers watch, a
# process begins so slowly that it takes a quarter of an executable's cases, and what cases share is
# computed once for them. With BUS its cases need the CAN
# buses vcan0, vcan1, can0 and can1, one case at a time; they carry the label `bus`, under which
# `./dev test` runs all of them in one `./dev vcan --controller`. With REAL_TIME its cases need vcan0
# and a machine that makes nothing late: they carry the label `real_time`, and run in one
# `./dev vcan --in machine --clock instructions`. With LONG its cases compute much: they start before others, so
# that none of them is left to run alone at the end. With AS_SHIPPED what it includes is optimised as a user's
# program is. With THREADS the thread sanitizer watches its cases of the name *Threads* alone: the others
# run the same loops, and each would take it minutes. Cases see "support/<header>.hpp" (tests/support).
#
# Where a directory sets OFFNOMINAL_TESTED_ONCE, `./dev test` builds and runs its cases once, under the address
# sanitizer: in the release build they carry the label `once`, are built by the target `tested_once` and not by
# `all`, are unknown to CTest until then, and wait for `./dev test release`, which takes their random ones
# twenty times as far. UNWATCHED: the sanitizers do not build this one.
function(offnominal_add_test)
  cmake_parse_arguments(PARSE_ARGV 0 arg "TOGETHER;BUS;REAL_TIME;LONG;AS_SHIPPED;THREADS;UNWATCHED"
                        "NAME;LABELS" "SOURCES;LIBRARIES")
  if(NOT arg_NAME OR NOT arg_SOURCES)
    message(FATAL_ERROR "offnominal_add_test: NAME and SOURCES are required")
  endif()
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "offnominal_add_test(${arg_NAME}): not understood: ${arg_UNPARSED_ARGUMENTS}"
                        " (gtest_discover_tests passes on one label only)")
  endif()

  add_executable(${arg_NAME} ${arg_SOURCES})
  # Every expectation holds the name of its file. Within the checkout it is the same in every clone:
  # what one has compiled is remembered for the others.
  target_compile_options(${arg_NAME} PRIVATE "-ffile-prefix-map=${PROJECT_SOURCE_DIR}/=")
  # Expectations are most of what a test compiles, and run once: half of a whole build was their
  # optimisation. What they test has been compiled as always; a header that is tested as it is shipped says
  # AS_SHIPPED. Where the sanitizers watch, no optimisation is the quickest to compile; tests that compute
  # much keep it.
  if(OFFNOMINAL_SANITIZE AND NOT arg_LONG)
    target_compile_options(${arg_NAME} PRIVATE -O0)
  elseif(NOT OFFNOMINAL_SANITIZE AND NOT arg_AS_SHIPPED)
    target_compile_options(${arg_NAME} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  target_link_libraries(
    ${arg_NAME} PRIVATE offnominal_warnings ${arg_LIBRARIES} offnominal_test_support GTest::gmock
                        GTest::gtest GTest::gtest_main)

  set(once OFF)
  if(OFFNOMINAL_TESTED_ONCE AND NOT OFFNOMINAL_SANITIZE AND NOT arg_UNWATCHED AND NOT arg_BUS
     AND NOT arg_REAL_TIME AND NOT arg_LABELS)
    set(once ON)
    set_target_properties(${arg_NAME} PROPERTIES EXCLUDE_FROM_ALL ON)
    if(NOT TARGET tested_once)
      add_custom_target(tested_once)
    endif()
    add_dependencies(tested_once ${arg_NAME})
  endif()

  set(properties PROPERTIES COST 0)
  if(arg_LONG)
    set(properties PROPERTIES COST 100)
  endif()
  if(arg_LABELS)
    list(APPEND properties LABELS ${arg_LABELS})
  elseif(arg_BUS)
    list(APPEND properties LABELS bus RESOURCE_LOCK can_buses)
  elseif(arg_REAL_TIME)
    list(APPEND properties LABELS real_time RESOURCE_LOCK can_buses)
  elseif(once)
    list(APPEND properties LABELS once)
  endif()
  if(arg_THREADS AND OFFNOMINAL_SANITIZE STREQUAL "thread")
    add_test(NAME ${arg_NAME} COMMAND ${arg_NAME} --gtest_filter=*Threads* --gtest_brief=1)
    set_tests_properties(${arg_NAME} ${properties} FAIL_REGULAR_EXPRESSION "PASSED  . 0 tests")
    return()
  endif()
  if(arg_TOGETHER)
    add_test(NAME ${arg_NAME} COMMAND ${arg_NAME})
    set_tests_properties(${arg_NAME} ${properties} ENVIRONMENT GTEST_BRIEF=1)
    return()
  endif()
  if(OFFNOMINAL_SANITIZE AND NOT arg_BUS AND NOT arg_REAL_TIME)
    set(parts 4)
    foreach(part RANGE 1 ${parts})
      math(EXPR index "${part} - 1")
      set(name "${arg_NAME}.${part}_of_${parts}")
      add_test(NAME ${name} COMMAND ${arg_NAME})
      set_tests_properties(
        ${name} ${properties} ENVIRONMENT "GTEST_BRIEF=1;GTEST_TOTAL_SHARDS=${parts};GTEST_SHARD_INDEX=${index}")
    endforeach()
    return()
  endif()
  # Asked at test time: a test executable that cannot start is then a failed test, not a failed build.
  gtest_discover_tests(${arg_NAME} TEST_PREFIX "${arg_NAME}." DISCOVERY_MODE PRE_TEST
                       DISCOVERY_TIMEOUT 60 ${properties})
  if(once)
    offnominal_know_when_built(${arg_NAME})
  endif()
endfunction()

# The cases that were registered last are those of an executable that `all` does not build: CTest reads them
# where it is there, instead of calling it a test that was not built.
function(offnominal_know_when_built name)
  get_property(files DIRECTORY PROPERTY TEST_INCLUDE_FILES)
  list(POP_BACK files cases)
  set(known "${CMAKE_CURRENT_BINARY_DIR}/${name}_when_built.cmake")
  file(GENERATE OUTPUT "${known}" CONTENT "if(EXISTS \"$<TARGET_FILE:${name}>\")\n  include(\"${cases}\")\nendif()\n")
  set_property(DIRECTORY PROPERTY TEST_INCLUDE_FILES ${files} "${known}")
endfunction()
