# offnominal_warnings: linked PRIVATE by every target of this project, never exported.
add_library(offnominal_warnings INTERFACE)
target_compile_options(
  offnominal_warnings INTERFACE -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow
                                -Wdouble-promotion -Werror)
# GCC 12 sees overlaps in operator+ of std::string that are none (GCC bug 105651), and vector loads
# beyond Eigen's smallest matrices where Eigen makes none. Clang's analysis and the address sanitizer
# look for the real ones.
target_compile_options(
  offnominal_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)
