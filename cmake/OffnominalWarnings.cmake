# offnominal_warnings: linked PRIVATE by every target of this project, never exported.
add_library(offnominal_warnings INTERFACE)
target_compile_options(
  offnominal_warnings INTERFACE -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow
                                -Wdouble-promotion -Werror)
# GCC 12 sees overlaps in operator+ of std::string that are none (GCC bug 105651).
target_compile_options(offnominal_warnings INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
