#include "inertial/pseudo_inertia.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <offnominal/model/chain.hpp>
#include <random>

#include "inertial/link_prior.hpp"
#include "mujoco_plant.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

using desk::InertialNumbers;
using desk::LogCholesky;
using desk::PseudoInertia;

LogCholesky random_point(std::mt19937_64& generator, double size) {
  std::normal_distribution<double> draw(0, size);
  return LogCholesky::NullaryExpr([&] { return draw(generator); });
}

double least_eigenvalue(const PseudoInertia& inertia) {
  return Eigen::SelfAdjointEigenSolver<PseudoInertia>(inertia).eigenvalues().minCoeff();
}

TEST(PseudoInertia, OfALinkIsPositiveDefiniteAndGivesItsNumbersBack) {
  for (const desk::RobotJoint& one : plain_arm(4).joints) {
    const InertialNumbers numbers = desk::inertial_numbers_of(one.joint);
    const PseudoInertia inertia = desk::pseudo_inertia_of(numbers);
    EXPECT_GT(least_eigenvalue(inertia), 0);
    EXPECT_LT((desk::inertial_numbers_of(inertia) - numbers).norm(), 1e-14 * numbers.norm());
    Joint<double> again = one.joint;
    desk::put_inertia(numbers, again);
    EXPECT_NEAR(again.mass_kg, one.joint.mass_kg, 1e-14);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_NEAR(again.inertia_kg_m2[i], one.joint.inertia_kg_m2[i], 1e-14);
    }
  }
}

TEST(PseudoInertia, OfWhatNoBodyCanHaveIsNotPositiveDefinite) {
  InertialNumbers numbers = desk::inertial_numbers_of(plain_arm(1).joints[0].joint);
  numbers[4] = numbers[5] + numbers[6] + 0.01;  // a moment above the sum of the others
  EXPECT_LT(least_eigenvalue(desk::pseudo_inertia_of(numbers)), 0);
}

TEST(LogCholesky, IsTheBodyThatItIsAboutAtZero) {
  const InertialNumbers numbers = desk::inertial_numbers_of(plain_arm(1).joints[0].joint);
  const Eigen::Matrix4d about = desk::upper_factor_of(desk::pseudo_inertia_of(numbers));
  EXPECT_LT((desk::inertial_numbers_at(about, LogCholesky::Zero()) - numbers).norm(), 1e-14);
  EXPECT_EQ(about(1, 0), 0);
  EXPECT_EQ(about(3, 2), 0);
}

TEST(LogCholesky, IsABodyThatThereCanBeWhereverItIs) {
  std::mt19937_64 generator = seeded_generator();
  const Joint<double> joint = plain_arm(1).joints[0].joint;
  const Eigen::Matrix4d about =
      desk::upper_factor_of(desk::pseudo_inertia_of(desk::inertial_numbers_of(joint)));
  for (int i = 0; i < 1000; ++i) {
    Joint<double> made = joint;
    desk::put_inertia(desk::inertial_numbers_at(about, random_point(generator, 1.5)), made);
    EXPECT_EQ(validate(made), Status::kOk);
  }
}

TEST(LogCholesky, HasTheSlopesOfItsNumbers) {
  std::mt19937_64 generator = seeded_generator();
  const Eigen::Matrix4d about = desk::upper_factor_of(
      desk::pseudo_inertia_of(desk::inertial_numbers_of(plain_arm(1).joints[0].joint)));
  for (int i = 0; i < 20; ++i) {
    const LogCholesky point = random_point(generator, 0.5);
    const auto slopes = desk::inertial_slopes_at(about, point);
    constexpr double kStep = 1e-6;
    for (Eigen::Index at = 0; at < 10; ++at) {
      LogCholesky above = point;
      LogCholesky below = point;
      above[at] += kStep;
      below[at] -= kStep;
      const InertialNumbers slope =
          (desk::inertial_numbers_at(about, above) - desk::inertial_numbers_at(about, below)) /
          (2 * kStep);
      EXPECT_LT((slope - slopes.col(at)).norm(), 1e-7 * (1 + slope.norm()));
    }
  }
}

TEST(BelievedInertia, HasExtentWhereTheFileHasAPointOrARod) {
  desk::RobotDescription robot = plain_arm(2);
  robot.joints[0].joint.inertia_kg_m2 = {};
  robot.joints[1].joint.inertia_kg_m2 = {0, 0.1, 0.1, 0, 0, 0};
  for (std::size_t link = 0; link < 2; ++link) {
    const PseudoInertia inertia = desk::believed_inertia(robot, link);
    EXPECT_GT(least_eigenvalue(inertia), 0);
    EXPECT_DOUBLE_EQ(inertia(3, 3), robot.joints[link].joint.mass_kg);
    EXPECT_DOUBLE_EQ(inertia(0, 3) / inertia(3, 3), robot.joints[link].joint.centre_of_mass_m[0]);
  }
}

TEST(JointsOfGeometry, AreBodiesBetweenTheirJoints) {
  const desk::RobotDescription robot = plain_arm(3);
  const auto joints = desk::joints_of_geometry(robot);
  for (const Joint<double>& joint : joints) EXPECT_EQ(validate(joint), Status::kOk);
  EXPECT_DOUBLE_EQ(joints[0].centre_of_mass_m[0], robot.joints[1].joint.origin_m[0] / 2);
  EXPECT_EQ(joints[2].centre_of_mass_m, (std::array<double, 3>{0, 0, 0}));
}

}  // namespace
}  // namespace offnominal::test
