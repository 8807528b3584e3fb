#pragma once

#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>

namespace offnominal::test {

inline constexpr std::uint64_t kDefaultSeed = 20240607;

/// Seed of a random test, printed so that a failure can be run again.
/// OFFNOMINAL_TEST_SEED gives it (an unsigned integer), or `random` draws a fresh one; without it
/// the seed is kDefaultSeed. Throws std::invalid_argument when the variable is neither.
inline std::uint64_t test_seed() {
  std::uint64_t seed = kDefaultSeed;
  if (const char* text = std::getenv("OFFNOMINAL_TEST_SEED"); text != nullptr && *text != '\0') {
    const std::string value(text);
    if (value == "random") {
      seed = std::random_device{}();
    } else {
      if (value.find_first_not_of("0123456789") != std::string::npos) {
        throw std::invalid_argument("OFFNOMINAL_TEST_SEED=" + value +
                                    ": an unsigned integer or `random` is allowed");
      }
      seed = std::stoull(value);
    }
  }
  std::cout << "[   SEED   ] OFFNOMINAL_TEST_SEED=" << seed << '\n';
  return seed;
}

/// Generator of a random test, seeded with test_seed().
inline std::mt19937_64 seeded_generator() { return std::mt19937_64{test_seed()}; }

}  // namespace offnominal::test
