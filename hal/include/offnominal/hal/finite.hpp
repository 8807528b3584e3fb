#pragma once

#include <bit>
#include <cstdint>

namespace offnominal::hal {

// Read from the bits: no compiler flag takes this away, as -ffinite-math-only does with
// std::isfinite and comparisons that NaN fails.
[[nodiscard]] constexpr bool is_finite(const float& x) {
  return std::bit_cast<std::uint32_t>(x) << 1U < 0xFF000000U;
}

}  // namespace offnominal::hal
