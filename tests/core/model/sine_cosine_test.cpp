#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/model/sine_cosine.hpp>

namespace offnominal {
namespace {

template <typename Scalar>
double largest_error(Scalar from, Scalar to, int count) {
  double largest = 0;
  for (int i = 0; i <= count; ++i) {
    const Scalar angle = from + (to - from) * static_cast<Scalar>(i) / static_cast<Scalar>(count);
    const auto exact = static_cast<long double>(angle);
    const SineCosine<Scalar> pair = sine_cosine(angle);
    const auto off = [&](Scalar value, long double right) {
      largest = std::fmax(largest,
                          static_cast<double>(std::fabs(static_cast<long double>(value) - right)));
    };
    off(pair.sine, std::sin(exact));
    off(pair.cosine, std::cos(exact));
  }
  return largest;
}

TEST(SineCosine, IsWithinItsErrorOnAFewTurns) {
  EXPECT_LT(largest_error<float>(-20, 20, 400'000), 1.5e-7);
  EXPECT_LT(largest_error<double>(-20, 20, 400'000), 4e-16);
}

TEST(SineCosine, IsWithinItsErrorAfterManyTurns) {
  EXPECT_LT(largest_error<float>(-1e4F, 1e4F, 400'000), 1.5e-7);
  EXPECT_LT(largest_error<double>(-1e5, 1e5, 400'000), 4e-16);
}

TEST(SineCosine, IsWithinItsErrorBesideEveryQuarterTurn) {
  constexpr double kQuarter = 1.57079632679489661923;
  for (int k = -1000; k <= 1000; ++k) {
    const double at = k * kQuarter;
    EXPECT_LT(largest_error<double>(at - 1e-9, at + 1e-9, 20), 4e-16) << k;
    const auto near = static_cast<float>(at);
    EXPECT_LT(largest_error<float>(near - 1e-4F, near + 1e-4F, 20), 1.5e-7) << k;
  }
}

TEST(SineCosine, IsExactAtZeroAndOddInTheSine) {
  EXPECT_EQ(sine_cosine(0.0F).sine, 0.0F);
  EXPECT_EQ(sine_cosine(0.0F).cosine, 1.0F);
  EXPECT_EQ(sine_cosine(0.7).sine, -sine_cosine(-0.7).sine);
  EXPECT_EQ(sine_cosine(0.7).cosine, sine_cosine(-0.7).cosine);
}

template <typename Scalar>
void expect_bounded_or_nan() {
  using Limits = std::numeric_limits<Scalar>;
  for (const Scalar angle : {Limits::max(), Limits::lowest(), Scalar(1e9), Limits::denorm_min()}) {
    EXPECT_LE(std::fabs(sine_cosine(angle).sine), Scalar(1)) << angle;
    EXPECT_LE(std::fabs(sine_cosine(angle).cosine), Scalar(1)) << angle;
  }
  for (const Scalar angle : {Limits::infinity(), -Limits::infinity(), Limits::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(sine_cosine(angle).sine)) << angle;
    EXPECT_TRUE(std::isnan(sine_cosine(angle).cosine)) << angle;
  }
}

TEST(SineCosine, StaysBoundedWhereAnglesMeanNothing) {
  expect_bounded_or_nan<float>();
  expect_bounded_or_nan<double>();
}

}  // namespace
}  // namespace offnominal
