#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace offnominal::hal {
namespace detail {

inline constexpr std::uint16_t kCrcPolynomial = 0x3D65;

[[nodiscard]] constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t remainder = byte << 8U;
    for (int bit = 0; bit < 8; ++bit) {
      const bool carry = (remainder & 0x8000U) != 0;
      remainder = (remainder << 1U) & 0xFFFFU;
      if (carry) remainder ^= kCrcPolynomial;
    }
    table[byte] = static_cast<std::uint16_t>(remainder);
  }
  return table;
}

inline constexpr std::array<std::uint16_t, 256> kCrcTable = make_crc_table();

}  // namespace detail

// CRC-16 of polynomial 0x3D65 (x^16 + x^13 + x^12 + x^11 + x^10 + x^8 + x^6 + x^5 + x^2 + 1), the
// register starting at `seed`, most significant bit first, nothing inverted. Hamming distance 6 up
// to 135 bits of data (P. Koopman, Best CRC Polynomials, 16 bits), where the check follows the data
// most significant byte first. Other seeds give other checks for the same data, always: a seed that
// only sender and receiver of one kind of message know tells it from all others.
[[nodiscard]] constexpr std::uint16_t crc16(std::span<const std::uint8_t> data,
                                            std::uint16_t seed) {
  std::uint32_t remainder = seed;
  for (const std::uint8_t byte : data) {
    remainder = ((remainder << 8U) & 0xFFFFU) ^ detail::kCrcTable[(remainder >> 8U) ^ byte];
  }
  return static_cast<std::uint16_t>(remainder);
}

}  // namespace offnominal::hal
