#include "robot/geometry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace offnominal::desk {
namespace {

using testing::HasSubstr;
constexpr double kQuarter = std::numbers::pi / 2;

TEST(RotationOfRpy, TurnsAboutFixedAxesRollFirst) {
  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const auto rows = rotation_of_rpy({kQuarter, 0, kQuarter});
  const Eigen::Vector3d z = Eigen::Map<const RowMajor>(rows.data()) * Eigen::Vector3d::UnitZ();
  // Roll takes z to -y, then yaw takes -y to x.
  EXPECT_LT((z - Eigen::Vector3d::UnitX()).norm(), 1e-15);
  const auto pitch = rotation_of_rpy({0, 0.3, 0});
  EXPECT_DOUBLE_EQ(pitch[2], std::sin(0.3)) << "pitch takes z towards x";
  EXPECT_DOUBLE_EQ(pitch[0], std::cos(0.3));
}

TEST(RotationOfRpy, OfNothingIsTheIdentityExactly) {
  EXPECT_EQ(rotation_of_rpy({0, 0, 0}), (std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
}

TEST(UnitVector, TakesLengthOneWithinOneInAMillion) {
  EXPECT_FALSE(unit_vector({0, 0, 1.00001}));
  EXPECT_FALSE(unit_vector({0, 0, 0}));
  EXPECT_FALSE(unit_vector({0, 0, std::nan("")}));
  EXPECT_EQ(unit_vector({0, 0, 1 - 5e-7}), (std::array<double, 3>{0, 0, 1}));
}

TEST(NearestRotation, MendsRoundedDigits) {
  const double c = 0.9553365;  // cos 0.3 and sin 0.3, rounded
  const double s = 0.2955202;
  const auto rotation = nearest_rotation({c, -s, 0, s, c, 0, 0, 0, 1});
  ASSERT_TRUE(rotation);
  EXPECT_NEAR((*rotation)[0], std::cos(0.3), 1e-7);
  EXPECT_NEAR((*rotation)[0] * (*rotation)[0] + (*rotation)[1] * (*rotation)[1], 1, 1e-15);
  EXPECT_FALSE(nearest_rotation({c, -s, 0, s, c, 0, 0, 0, 1.01}));
}

TEST(InertiaFault, SaysWhichLawIsBroken) {
  EXPECT_EQ(inertia_fault({0, 0, 0, 0, 0, 0}), "");
  EXPECT_EQ(inertia_fault({1, 1, 1, 0, 0, 0}), "");
  EXPECT_EQ(inertia_fault({1, 1, 2, 0, 0, 0}), "") << "a plate";
  EXPECT_THAT(inertia_fault({1, 1, -1, 0, 0, 0}),
              HasSubstr("not positive definite (principal moments -1, 1, 1)"));
  EXPECT_THAT(inertia_fault({1, 1, 1, 2, 0, 0}),
              HasSubstr("not positive definite (principal moments -1, 1, 3)"));
  EXPECT_THAT(inertia_fault({1, 1, 3, 0, 0, 0}),
              HasSubstr("triangle inequality (principal moments 1, 1, 3"));
}

TEST(BrokenTriangle, IsAShareOfTheLargestMomentOfATensorThatIsPositive) {
  EXPECT_NEAR(broken_triangle({1, 1, 4, 0, 0, 0}).value_or(0), 0.5, 1e-12);
  EXPECT_FALSE(broken_triangle({1, 1, 2, 0, 0, 0}));
  EXPECT_FALSE(broken_triangle({1, 1, -1, 0, 0, 0}));
}

// Second moments (trace / 2 - moment): those below zero become none.
TEST(NearestInertia, IsOneThatABodyCanHave) {
  const auto plate = nearest_inertia({1, 1, 4, 0, 0, 0});  // seconds 2, 2, -1
  ASSERT_TRUE(plate);
  const double of_plate[]{2, 2, 4};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR((*plate)[i], of_plate[i], 1e-4) << i;
  // Turned by 45 deg: principal moments -1, 1, 3 along (1, -1, 0), z and (1, 1, 0).
  const auto mended = nearest_inertia({1, 1, 1, 2, 0, 0});  // seconds 2.5, 0.5, -1.5
  ASSERT_TRUE(mended);
  EXPECT_EQ(inertia_fault(*mended), "");
  const double by_hand[]{1.75, 1.75, 2.5, 1.25, 0, 0};  // principal 0.5, 2.5, 3
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((*mended)[i], by_hand[i], 1e-4) << i;
  EXPECT_FALSE(nearest_inertia({-1, 1, -1, 0, 0, 0}));
}

}  // namespace
}  // namespace offnominal::desk
