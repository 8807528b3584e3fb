#include "offnominal/sim/hidden/draws.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace offnominal::sim::hidden {
namespace {

// The first numbers of one stream, written down: another compiler or library must give the same.
TEST(Draws, AreTheSameEverywhere) {
  Draws draws(1, Stream::kArm);
  EXPECT_EQ(draws.uniform(0.0, 1.0), 0x1.9e29089a6cc8ep-2);
  EXPECT_EQ(draws.uniform(0.0, 1.0), 0x1.e8098ade7cf14p-3);
}

TEST(Draws, StreamsAndIndicesDiffer) {
  const double first = Draws(1, Stream::kArm).uniform(0.0, 1.0);
  EXPECT_NE(first, Draws(2, Stream::kArm).uniform(0.0, 1.0));
  EXPECT_NE(first, Draws(1, Stream::kNoise).uniform(0.0, 1.0));
  EXPECT_NE(first, Draws(1, Stream::kArm, 1).uniform(0.0, 1.0));
}

TEST(Draws, GaussianHasItsMoments) {
  Draws draws(1, Stream::kNoise);
  constexpr int kCount = 200000;
  double sum = 0.0, square = 0.0, fourth = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = draws.gaussian();
    ASSERT_TRUE(std::isfinite(x));
    sum += x / kCount;
    square += x * x / kCount;
    fourth += x * x * x * x / kCount;
  }
  EXPECT_NEAR(sum, 0.0, 0.01);
  EXPECT_NEAR(square, 1.0, 0.015);
  EXPECT_NEAR(fourth, 3.0, 0.15);
}

TEST(Draws, WholeNumbersCoverTheirRange) {
  Draws draws(1, Stream::kArm);
  int seen[3] = {0, 0, 0};
  for (int i = 0; i < 3000; ++i) ++seen[draws.below(3)];
  for (const int count : seen) EXPECT_NEAR(count, 1000, 150);
}

}  // namespace
}  // namespace offnominal::sim::hidden
