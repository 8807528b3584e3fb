#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/exponential.hpp>

namespace offnominal {
namespace {

template <typename Scalar>
double largest_relative_error(Scalar most) {
  constexpr int kSteps = 500'000;
  double largest = 0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const Scalar x = most * static_cast<Scalar>(i) / static_cast<Scalar>(kSteps);
    const auto exact = std::exp(static_cast<long double>(x));
    largest = std::fmax(
        largest,
        static_cast<double>(std::fabs(static_cast<long double>(exponential(x)) / exact - 1)));
  }
  return largest;
}

TEST(Exponential, IsWithinItsError) {
  EXPECT_LT(largest_relative_error<float>(87), 2e-7);
  EXPECT_LT(largest_relative_error<double>(708), 5e-16);
  EXPECT_EQ(exponential(0.0F), 1.0F);
  EXPECT_EQ(exponential(0.0), 1.0);
}

TEST(Exponential, IsHeldBeyondItsRange) {
  using Limits = std::numeric_limits<double>;
  EXPECT_EQ(exponential(1e30F), exponential(87.0F));
  EXPECT_EQ(exponential(-1e30F), exponential(-87.0F));
  EXPECT_EQ(exponential(Limits::infinity()), exponential(708.0));
  EXPECT_EQ(exponential(-Limits::infinity()), exponential(-708.0));
  EXPECT_GT(exponential(-Limits::max()), 0.0);
  EXPECT_TRUE(std::isnan(exponential(Limits::quiet_NaN())));
  EXPECT_TRUE(std::isnan(exponential(std::numeric_limits<float>::quiet_NaN())));
}

}  // namespace
}  // namespace offnominal
