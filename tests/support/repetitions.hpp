#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

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

/// Cases to go through: all of a list, or its first and each n-th after it where the sanitizers
/// watch. n is at least 1.
template <typename Cases>
auto every_nth(const Cases& all, [[maybe_unused]] std::size_t n) {
#ifdef OFFNOMINAL_SANITIZE
  const std::size_t step = n;
#else
  const std::size_t step = 1;
#endif
  std::vector<typename Cases::value_type> some;
  for (std::size_t i = 0; i < std::size(all); i += step) some.push_back(all[i]);
  return some;
}

}  // namespace offnominal::test
