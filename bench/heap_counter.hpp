#pragma once

#include <cstdint>

namespace offnominal::bench {

// Calls of malloc, calloc, realloc, aligned_alloc, posix_memalign and operator new by this process
// so far. The benchmark's executable replaces those functions (glibc) to count them.
[[nodiscard]] std::uint64_t heap_calls();

}  // namespace offnominal::bench
