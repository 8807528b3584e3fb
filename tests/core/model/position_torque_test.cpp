#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/model/effect_list.hpp>
#include <random>

#include "support/seed.hpp"

// The curve is the B-spline that books have: C. de Boor, A Practical Guide to Splines, 2001.

namespace offnominal::test {
namespace {

constexpr std::size_t kTorques = 6;
constexpr std::size_t kFirst = 2;

using Parameters = std::array<double, kMaxEffectParameters>;

double torque_at(const Parameters& p, double q) {
  return effects::PositionTorque::torque(p, JointInstant<double>{q, 0, 0, 0});
}

Parameters random_curve(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> any(-5, 5);
  Parameters p{-1.3, 2.7};
  for (std::size_t i = 0; i < kTorques; ++i) p[kFirst + i] = any(generator);
  return p;
}

// The recursion over all knots, with 0 for what is divided by none.
double basis(std::size_t i, std::size_t degree, double u) {
  constexpr std::array<double, 10> kKnots{0, 0, 0, 0, 1, 2, 3, 3, 3, 3};
  if (degree == 0) {
    const bool last = u >= 3 && kKnots[i] < kKnots[i + 1] && kKnots[i + 1] >= 3;
    return (u >= kKnots[i] && u < kKnots[i + 1]) || last ? 1 : 0;
  }
  const double up = kKnots[i + degree] - kKnots[i];
  const double down = kKnots[i + degree + 1] - kKnots[i + 1];
  const double rising = up > 0 ? (u - kKnots[i]) / up * basis(i, degree - 1, u) : 0;
  const double falling =
      down > 0 ? (kKnots[i + degree + 1] - u) / down * basis(i + 1, degree - 1, u) : 0;
  return rising + falling;
}

TEST(PositionTorque, IsTheSumOfItsTorquesTimesTheirBSplines) {
  auto generator = seeded_generator();
  const Parameters p = random_curve(generator);
  for (int k = 0; k <= 60; ++k) {
    const double u = 3.0 * k / 60;
    double expected = 0;
    for (std::size_t i = 0; i < kTorques; ++i) expected += p[kFirst + i] * basis(i, 3, u);
    EXPECT_NEAR(torque_at(p, p[0] + u / 3 * p[1]), expected, 1e-12) << u;
  }
}

TEST(PositionTorque, IsConstantOutsideOfItsRangeAndBeginsAndEndsAtItsOuterTorques) {
  auto generator = seeded_generator();
  const Parameters p = random_curve(generator);
  EXPECT_EQ(torque_at(p, p[0]), p[kFirst]);
  EXPECT_EQ(torque_at(p, p[0] - 100), p[kFirst]);
  EXPECT_NEAR(torque_at(p, p[0] + p[1]), p[kFirst + 5], 1e-14);
  EXPECT_EQ(torque_at(p, p[0] + p[1] + 0.5), torque_at(p, 1e9));
}

TEST(PositionTorque, HasNoStepOfValueSlopeOrCurvatureWhereItsPiecesMeet) {
  auto generator = seeded_generator();
  const Parameters p = random_curve(generator);
  const double h = 1e-3 * p[1];
  for (const double meet : {p[0] + p[1] / 3, p[0] + 2 * p[1] / 3}) {
    const auto curved = [&](double q) {
      return (torque_at(p, q - h) - 2 * torque_at(p, q) + torque_at(p, q + h)) / (h * h);
    };
    const double third = std::abs(curved(meet + 2 * h) - curved(meet - 2 * h));
    EXPECT_LT(third, 2) << "a step of the slope would be about 1000 here";
  }
}

TEST(PositionTorque, HoldsALineExactlyAndStaysBetweenItsTorques) {
  auto generator = seeded_generator();
  Parameters line{0.4, 1.8};
  constexpr std::array<double, kTorques> kPlaces{0, 1.0 / 9, 1.0 / 3, 2.0 / 3, 8.0 / 9, 1};
  for (std::size_t i = 0; i < kTorques; ++i) line[kFirst + i] = 2 - 5 * kPlaces[i];
  const Parameters p = random_curve(generator);
  const auto [least, most] = std::minmax_element(p.begin() + kFirst, p.end());
  for (int k = -10; k <= 70; ++k) {
    const double share = std::clamp(k / 60.0, 0.0, 1.0);
    EXPECT_NEAR(torque_at(line, 0.4 + 1.8 * k / 60.0), 2 - 5 * share, 1e-12);
    const double torque = torque_at(p, p[0] + p[1] * k / 60.0);
    EXPECT_GE(torque, *least - 1e-12);
    EXPECT_LE(torque, *most + 1e-12);
  }
}

TEST(PositionTorque, OfAPositionThatIsNoNumberIsNoNumber) {
  auto generator = seeded_generator();
  const Parameters p = random_curve(generator);
  EXPECT_TRUE(std::isnan(torque_at(p, std::numeric_limits<double>::quiet_NaN())));
}

TEST(PositionTorque, IsTheSameInFloat) {
  auto generator = seeded_generator();
  const Parameters p = random_curve(generator);
  std::array<float, kMaxEffectParameters> narrow{};
  for (std::size_t i = 0; i < p.size(); ++i) narrow[i] = static_cast<float>(p[i]);
  for (int k = -5; k <= 35; ++k) {
    const double q = p[0] + p[1] * k / 30.0;
    const float torque = effects::PositionTorque::torque(
        narrow, JointInstant<float>{static_cast<float>(q), 0.0F, 0, 0.0F});
    EXPECT_NEAR(static_cast<double>(torque), torque_at(p, q), 2e-5);
  }
}

}  // namespace
}  // namespace offnominal::test
