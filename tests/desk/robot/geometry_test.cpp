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

}  // namespace
}  // namespace offnominal::desk
