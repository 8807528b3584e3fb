#include <gtest/gtest.h>

#include <array>
#include <offnominal/hal/crc.hpp>
#include <random>
#include <span>
#include <string_view>

#include "bitwise_crc.hpp"
#include "support/seed.hpp"

namespace offnominal::hal {
namespace {

TEST(Crc, EqualsLongDivisionOnRandomBytesOfEveryLength) {
  std::mt19937_64 random = test::seeded_generator();
  std::uniform_int_distribution<int> byte(0, 255);
  std::uniform_int_distribution<int> word(0, 65535);
  std::array<std::uint8_t, 64> data{};
  for (std::size_t length = 0; length <= data.size(); ++length) {
    for (int repeat = 0; repeat < 20; ++repeat) {
      for (auto& value : data) value = static_cast<std::uint8_t>(byte(random));
      const auto seed = static_cast<std::uint16_t>(word(random));
      const auto part = std::span<const std::uint8_t>(data).first(length);
      ASSERT_EQ(crc16(part, seed), test::bitwise_crc(part, seed)) << "length " << length;
    }
  }
}

// CRC-16/EN-13757 of the catalogue of parametrised CRC algorithms is the same polynomial with its
// result inverted: check value 0xC2B7.
TEST(Crc, GivesThePublishedCheckValueOfItsPolynomial) {
  constexpr std::string_view kCheck = "123456789";
  std::array<std::uint8_t, 9> data{};
  std::copy(kCheck.begin(), kCheck.end(), data.begin());
  EXPECT_EQ(crc16(data, 0) ^ 0xFFFFU, 0xC2B7U);
}

}  // namespace
}  // namespace offnominal::hal
