# Cross-compilation for Cortex-M with Debian's arm-none-eabi-gcc and newlib:
#
#   cmake -DCMAKE_TOOLCHAIN_FILE=toolchain.cmake -DOFFNOMINAL_CPU=cortex-m7 ...
#
# OFFNOMINAL_CPU: cortex-m7 (double-precision FPU), cortex-m7sp (an M7 with the single-precision one,
# as in the STM32F746), cortex-m4f, cortex-m33. All pass floating-point arguments in FPU registers.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)

set(OFFNOMINAL_CPU cortex-m7 CACHE STRING "cortex-m7, cortex-m7sp, cortex-m4f or cortex-m33")
set_property(CACHE OFFNOMINAL_CPU PROPERTY STRINGS cortex-m7 cortex-m7sp cortex-m4f cortex-m33)
# What try_compile() configures needs it too.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES OFFNOMINAL_CPU)

if(OFFNOMINAL_CPU STREQUAL "cortex-m7")
  set(_cpu "-mcpu=cortex-m7 -mfpu=fpv5-d16")
elseif(OFFNOMINAL_CPU STREQUAL "cortex-m7sp")
  set(_cpu "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16")
elseif(OFFNOMINAL_CPU STREQUAL "cortex-m4f")
  set(_cpu "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16")
elseif(OFFNOMINAL_CPU STREQUAL "cortex-m33")
  set(_cpu "-mcpu=cortex-m33 -mfpu=fpv5-sp-d16")
else()
  message(FATAL_ERROR "OFFNOMINAL_CPU is `${OFFNOMINAL_CPU}`; allowed: cortex-m7, cortex-m7sp, cortex-m4f, "
                      "cortex-m33")
endif()

set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
set(CMAKE_C_FLAGS_INIT "${_cpu} -mthumb -mfloat-abi=hard")
set(CMAKE_ASM_FLAGS_INIT "${CMAKE_C_FLAGS_INIT}")
# No heap, no exceptions, no RTTI, no locks around statics: what the core is written for.
# -fno-math-errno lets a square root be the FPU's one instruction.
set(CMAKE_CXX_FLAGS_INIT
    "${CMAKE_C_FLAGS_INIT} -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-unwind-tables \
-fno-asynchronous-unwind-tables -fno-math-errno -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections")

# Start-up code and libraries are the firmware's own business: a test program does not link.
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
