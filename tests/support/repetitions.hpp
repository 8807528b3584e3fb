#pragma once

#include <algorithm>

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

}  // namespace offnominal::test
