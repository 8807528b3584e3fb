#pragma once

#include <algorithm>
#include <cstddef>

namespace offnominal::test {

/// How often a random test repeats itself: n times, or a twentieth of it where the sanitizers
/// watch, which slow every run down and look for faults that the first runs have as well.
constexpr int repetitions(int n) {
#ifdef OFFNOMINAL_SANITIZE
  return std::max(1, n / 20);
#else
  return n;
#endif
}

/// Step through a list of cases: all of them, or each n-th where the sanitizers watch.
constexpr std::size_t stride(std::size_t n) {
#ifdef OFFNOMINAL_SANITIZE
  return n;
#else
  return n > 0 ? 1 : 0;
#endif
}

}  // namespace offnominal::test
