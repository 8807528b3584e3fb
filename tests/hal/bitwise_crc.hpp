// The CRC bit by bit, as long division of the message by the polynomial: slow, and nothing of the
// code that it judges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace offnominal::test {

inline std::uint16_t bitwise_crc(std::span<const std::uint8_t> data, std::uint16_t seed) {
  constexpr std::uint32_t kDivisor = 0x13D65;  // with its leading term
  std::uint32_t remainder = seed;
  for (const std::uint8_t byte : data) {
    for (int bit = 7; bit >= 0; --bit) {
      remainder = (remainder << 1U) ^ (((byte >> static_cast<unsigned>(bit)) & 1U) << 16U);
      if ((remainder & 0x10000U) != 0) remainder ^= kDivisor;
    }
  }
  return static_cast<std::uint16_t>(remainder);
}

}  // namespace offnominal::test
