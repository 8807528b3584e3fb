#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <offnominal/diagnosis/bound.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/model/random_chain.hpp"
#include "core/print_status.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using Bound = UncertaintyBound<2, double>;

Bound constant_bound() {
  Bound bound;
  bound.offset = 0.7;
  return bound;
}

// The paper's 4.4 (|2 dq1 - 6 dq2| + 1).
template <typename Scalar>
UncertaintyBound<2, Scalar> paper_bound() {
  UncertaintyBound<2, Scalar> bound;
  bound.kind = BoundKind::kScaledNorm;
  bound.scale = Scalar(4.4);
  bound.offset = 1;
  bound.matrix = {2, -6, 0, 0};
  return bound;
}

Bound table_bound() {
  Bound bound;
  bound.kind = BoundKind::kTable;
  bound.variable = BoundVariable::kSpeed;
  bound.joint = 1;
  bound.points = 3;
  bound.at = {0, 1, 3};
  bound.value = {2, 4, 1};
  return bound;
}

double at_speed(const Bound& bound, double speed) {
  const Eigen::Vector2d elsewhere(17, -5);
  return evaluate<2, double>(bound, elsewhere, {99, speed}, elsewhere);
}

TEST(Bound, TheConstantOneIsItsOffsetEverywhere) {
  EXPECT_EQ(at_speed(constant_bound(), 0), 0.7);
  EXPECT_EQ(at_speed(constant_bound(), 1e9), 0.7);
}

template <typename Scalar>
void expect_paper_bound(std::mt19937_64& generator, double relative_tolerance) {
  const auto bound = paper_bound<Scalar>();
  ASSERT_EQ(validate(bound), Status::kOk);
  for (int sample = 0; sample < 1000; ++sample) {
    const auto q = random_vector<2, Scalar>(generator, 3);
    const auto dq = random_vector<2, Scalar>(generator, 3);
    const double dq1 = static_cast<double>(dq[0]);
    const double dq2 = static_cast<double>(dq[1]);
    const double expected = 4.4 * (std::fabs(2 * dq1 - 6 * dq2) + 1);
    const auto actual = static_cast<double>(evaluate(bound, q, dq, q));
    EXPECT_NEAR(actual, expected, relative_tolerance * expected);
  }
}

TEST(Bound, TheScaledNormHoldsThePapersBound) {
  std::mt19937_64 generator = seeded_generator();
  expect_paper_bound<double>(generator, 1e-14);
  // The two products under the norm may cancel: their roundings count against 4.4 at least.
  expect_paper_bound<float>(generator, 1e-5);
}

TEST(Bound, TheScaledNormIsTheEuclideanNormOfAllRowsOfTheMatrix) {
  Bound bound = paper_bound<double>();
  bound.matrix = {1, 2, 3, 4};
  bound.scale = 2;
  bound.offset = 0.5;
  const Eigen::Vector2d dq(0.3, -0.7);
  const double expected = 2 * (std::hypot(0.3 - 1.4, 0.9 - 2.8) + 0.5);
  EXPECT_NEAR((evaluate<2, double>(bound, dq, dq, dq)), expected, 1e-14);
}

TEST(Bound, TheScaledNormOfOneJoint) {
  UncertaintyBound<1, double> bound;
  bound.kind = BoundKind::kScaledNorm;
  bound.matrix = {-3};
  const Vector<1, double> dq(2.0);
  EXPECT_NEAR((evaluate<1, double>(bound, dq, dq, dq)), 7.0, 1e-14);
}

TEST(Bound, TheTableInterpolatesAndHoldsItsEndValues) {
  const Bound bound = table_bound();
  EXPECT_EQ(at_speed(bound, 0), 2);
  EXPECT_NEAR(at_speed(bound, 0.25), 2.5, 1e-14);
  EXPECT_NEAR(at_speed(bound, -0.25), 2.5, 1e-14) << "speed has no sign";
  EXPECT_NEAR(at_speed(bound, 1), 4, 1e-14);
  EXPECT_NEAR(at_speed(bound, 2), 2.5, 1e-14);
  EXPECT_NEAR(at_speed(bound, 3), 1, 1e-14);
  EXPECT_NEAR(at_speed(bound, 1e6), 1, 1e-14);
}

TEST(Bound, TheTableReadsPositionWithItsSignAndTorqueWithout) {
  Bound bound = table_bound();
  bound.at = {-1, 0, 1};
  const Eigen::Vector2d zero = Eigen::Vector2d::Zero();
  bound.variable = BoundVariable::kPosition;
  EXPECT_NEAR((evaluate<2, double>(bound, {0, -0.5}, zero, zero)), 3.0, 1e-14);
  EXPECT_NEAR((evaluate<2, double>(bound, {0, 0.5}, zero, zero)), 2.5, 1e-14);
  EXPECT_NEAR((evaluate<2, double>(bound, {0, -9}, zero, zero)), 2.0, 1e-14);
  bound.variable = BoundVariable::kTorque;
  EXPECT_NEAR((evaluate<2, double>(bound, zero, zero, {0, -0.5})), 2.5, 1e-14);
  EXPECT_NEAR((evaluate<2, double>(bound, zero, zero, {0, 0.5})), 2.5, 1e-14);
}

TEST(Bound, ATableOfOnePointIsThatValueEverywhere) {
  Bound bound = table_bound();
  bound.points = 1;
  ASSERT_EQ(validate(bound), Status::kOk);
  EXPECT_EQ(at_speed(bound, 0), 2);
  EXPECT_EQ(at_speed(bound, 5), 2);
}

TEST(Bound, AFullTableIsUsedToItsLastPoint) {
  Bound bound = table_bound();
  bound.points = kMaxTablePoints;
  for (std::size_t i = 0; i < kMaxTablePoints; ++i) {
    bound.at[i] = static_cast<double>(i);
    bound.value[i] = static_cast<double>(1 + i * i);
  }
  ASSERT_EQ(validate(bound), Status::kOk);
  for (std::size_t i = 0; i < kMaxTablePoints; ++i) {
    EXPECT_NEAR(at_speed(bound, static_cast<double>(i)), bound.value[i], 1e-12);
  }
  EXPECT_NEAR(at_speed(bound, 14.5), (bound.value[14] + bound.value[15]) / 2, 1e-12);
}

TEST(Bound, TheVelocityErrorIsNotPartOfItsValue) {
  Bound bound = constant_bound();
  bound.velocity_error = 3;
  ASSERT_EQ(validate(bound), Status::kOk);
  EXPECT_EQ(at_speed(bound, 1), 0.7);
}

TEST(Bound, NaNGivesNaNWhereTheBoundDependsOnIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(at_speed(paper_bound<double>(), nan)));
  EXPECT_TRUE(std::isnan(at_speed(table_bound(), nan)));
}

struct Refusal {
  std::string name;
  Bound bound;
};

std::vector<Refusal> refusals() {
  std::vector<Refusal> all;
  const auto add = [&](const std::string& name, Bound bound, auto&& spoil) {
    spoil(bound);
    all.push_back({name, bound});
  };
  const Bound scaled = paper_bound<double>();
  const Bound table = table_bound();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  add("UnknownKind", constant_bound(), [](Bound& b) { b.kind = static_cast<BoundKind>(9); });
  add("ConstantZero", constant_bound(), [](Bound& b) { b.offset = 0; });
  add("ConstantNegative", constant_bound(), [](Bound& b) { b.offset = -1; });
  add("ScaleZero", scaled, [](Bound& b) { b.scale = 0; });
  add("ScaleNegative", scaled, [](Bound& b) { b.scale = -1; });
  add("ScaledOffsetNegative", scaled, [](Bound& b) { b.offset = -1; });
  add("TableEmpty", table, [](Bound& b) { b.points = 0; });
  add("TableTooLong", table, [](Bound& b) { b.points = kMaxTablePoints + 1; });
  add("TableOfAJointThatIsNotThere", table, [](Bound& b) { b.joint = 2; });
  add("TableStandingStill", table, [](Bound& b) { b.at[1] = b.at[0]; });
  add("TableFalling", table, [](Bound& b) { b.at[2] = 0.5; });
  add("TableValueZero", table, [](Bound& b) { b.value[2] = 0; });
  add("TableValueNegative", table, [](Bound& b) { b.value[0] = -1; });
  const std::vector<std::pair<std::string, Bound>> kinds{
      {"Constant", constant_bound()}, {"ScaledNorm", scaled}, {"Table", table}};
  for (const auto& [kind, bound] : kinds) {
    add("VelocityErrorNegativeOf" + kind, bound, [](Bound& b) { b.velocity_error = -0.1; });
    add("VelocityErrorNaNOf" + kind, bound, [=](Bound& b) { b.velocity_error = nan; });
    add("VelocityErrorInfiniteOf" + kind, bound, [=](Bound& b) { b.velocity_error = infinity; });
  }
  for (const double bad : {nan, infinity}) {
    const std::string name = std::isnan(bad) ? "NaN" : "Infinite";
    add("Constant" + name, constant_bound(), [=](Bound& b) { b.offset = bad; });
    add("Scale" + name, scaled, [=](Bound& b) { b.scale = bad; });
    add("ScaledOffset" + name, scaled, [=](Bound& b) { b.offset = bad; });
    add("Matrix" + name, scaled, [=](Bound& b) { b.matrix[3] = bad; });
    add("TableAt" + name, table, [=](Bound& b) { b.at[2] = bad; });
    add("TableValue" + name, table, [=](Bound& b) { b.value[2] = bad; });
  }
  return all;
}

class BoundValidation : public testing::TestWithParam<Refusal> {};

TEST_P(BoundValidation, IsRefused) {
  ASSERT_EQ(validate(constant_bound()), Status::kOk);
  ASSERT_EQ(validate(paper_bound<double>()), Status::kOk);
  ASSERT_EQ(validate(table_bound()), Status::kOk);
  EXPECT_EQ(validate(GetParam().bound), Status::kInvalidBound);
}

INSTANTIATE_TEST_SUITE_P(All, BoundValidation, testing::ValuesIn(refusals()),
                         [](const testing::TestParamInfo<Refusal>& tested) {
                           return tested.param.name;
                         });

}  // namespace
}  // namespace offnominal::test
