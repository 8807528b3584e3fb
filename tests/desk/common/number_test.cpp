#include "common/number.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

TEST(Shortest, IsShort) {
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(-3), "-3");
  EXPECT_EQ(shortest(-0.0), "-0");
  EXPECT_EQ(shortest(1e22), "1e+22");
  EXPECT_EQ(shortest(std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(ShortestReal, HasAPointOrAnExponent) {
  EXPECT_EQ(shortest_real(0.1), "0.1");
  EXPECT_EQ(shortest_real(-3), "-3.0");
  EXPECT_EQ(shortest_real(-0.0), "-0.0");
  EXPECT_EQ(shortest_real(1e22), "1e+22");
}

TEST(Shortest, IsReadBackToTheBit) {
  auto generator = test::seeded_generator();
  for (int i = 0; i < 10000; ++i) {
    const double value = std::bit_cast<double>(static_cast<std::uint64_t>(generator()));
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(std::strtod(shortest(value).c_str(), nullptr), value) << shortest(value);
  }
}

}  // namespace
}  // namespace offnominal::desk
