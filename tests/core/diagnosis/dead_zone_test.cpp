#include <gtest/gtest.h>

#include <limits>
#include <offnominal/diagnosis/dead_zone.hpp>

#include "core/model/random_chain.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

constexpr auto kContinuous = DeadZone::kContinuous;
constexpr auto kDiscontinuous = DeadZone::kDiscontinuous;

template <typename Scalar>
class DeadZoneOf : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(DeadZoneOf, Scalars);

// Erratum 5: at t = 0 error and threshold are both zero.
TYPED_TEST(DeadZoneOf, GivenNoErrorAndNoThresholdThenItIsZero) {
  using Vec = Vector<2, TypeParam>;
  for (const DeadZone kind : {kContinuous, kDiscontinuous}) {
    EXPECT_EQ((dead_zone<2, TypeParam>(Vec::Zero(), TypeParam(0), kind)), Vec::Zero().eval());
    EXPECT_EQ((dead_zone<2, TypeParam>(Vec::Zero(), TypeParam(1), kind)), Vec::Zero().eval());
  }
}

TYPED_TEST(DeadZoneOf, GivenAnErrorWithinTheThresholdThenItIsExactlyZero) {
  using Vec = Vector<2, TypeParam>;
  std::mt19937_64 generator = seeded_generator();
  for (int sample = 0; sample < 1000; ++sample) {
    const auto mu = static_cast<TypeParam>(uniform(generator, 0, 2));
    const Vec direction = random_direction(generator).template head<2>().template cast<TypeParam>();
    const Vec e = direction * mu * static_cast<TypeParam>(uniform(generator, 0, 0.99));
    EXPECT_EQ((dead_zone<2, TypeParam>(e, mu, kContinuous)), Vec::Zero().eval());
    EXPECT_EQ((dead_zone<2, TypeParam>(e, mu, kDiscontinuous)), Vec::Zero().eval());
  }
}

TYPED_TEST(DeadZoneOf, GivenAnErrorOutsideThenItIsTheErrorOrTheErrorShrunkByTheThreshold) {
  using Vec = Vector<3, TypeParam>;
  std::mt19937_64 generator = seeded_generator();
  const TypeParam tolerance = 16 * std::numeric_limits<TypeParam>::epsilon();
  for (int sample = 0; sample < 1000; ++sample) {
    const auto mu = static_cast<TypeParam>(uniform(generator, 0, 2));
    const Vec direction = random_direction(generator).template cast<TypeParam>();
    const Vec e =
        direction * (mu * TypeParam(1.01) + static_cast<TypeParam>(uniform(generator, 0.01, 3)));
    EXPECT_EQ((dead_zone<3, TypeParam>(e, mu, kDiscontinuous)), e);
    const Vec shrunk = dead_zone<3, TypeParam>(e, mu, kContinuous);
    EXPECT_NEAR(shrunk.norm(), e.norm() - mu, 4 * tolerance);
    EXPECT_LE((shrunk.normalized() - e.normalized()).norm(), tolerance * e.norm() / shrunk.norm());
  }
}

TYPED_TEST(DeadZoneOf, TheContinuousOneHasNoJumpAtTheThresholdAndTheOtherOneJumpsByIt) {
  using Vec = Vector<1, TypeParam>;
  const TypeParam mu = 2;
  const TypeParam just_outside = mu * (1 + 4 * std::numeric_limits<TypeParam>::epsilon());
  const auto of = [&](DeadZone kind, TypeParam error) {
    return dead_zone<1, TypeParam>(Vec(error), mu, kind)[0];
  };
  EXPECT_EQ(of(kContinuous, mu), TypeParam(0));
  EXPECT_EQ(of(kDiscontinuous, mu), TypeParam(0));
  EXPECT_NEAR(of(kContinuous, just_outside), TypeParam(0),
              16 * std::numeric_limits<TypeParam>::epsilon());
  EXPECT_EQ(of(kDiscontinuous, just_outside), just_outside);
  EXPECT_EQ(of(kDiscontinuous, -just_outside), -just_outside);
}

TYPED_TEST(DeadZoneOf, GivenNoThresholdThenItIsTheErrorHoweverSmall) {
  using Vec = Vector<1, TypeParam>;
  const Vec e(TypeParam(1e-15));
  EXPECT_EQ((dead_zone<1, TypeParam>(e, TypeParam(0), kContinuous)), e);
  EXPECT_EQ((dead_zone<1, TypeParam>(e, TypeParam(0), kDiscontinuous)), e);
}

}  // namespace
}  // namespace offnominal::test
