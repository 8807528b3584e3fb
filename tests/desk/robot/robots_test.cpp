#include "support/robots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/mass_matrix.hpp>

#include "robot/monitor_config_of.hpp"
#include "robot/robot_file.hpp"

// The robots that come with the project.

namespace offnominal::desk {
namespace {

using test::kRobots;

TEST(Robots, AreAllReadAndAcceptedByTheCore) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kRobots)) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    ++count;
    RobotDescription robot = read_robot_file(entry.path());
    // A file that is there for analysis alone has no bound: any will do to look at the rest.
    if (!robot.bound) robot.bound.emplace();
    EXPECT_EQ(robot.name, entry.path().stem());
    EXPECT_FALSE(robot.source.empty());
    const Status status =
        validate<kMaxHiddenUnits>(monitor_config_of<kRuntimeJoints, float>(robot));
    EXPECT_EQ(status, Status::kOk) << name_of(status);
  }
  EXPECT_GE(count, 2);
}

TEST(Robots, TwoLinkHasTheMassMatrixAndGravityOfThePaper) {
  const RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  const auto model = make_model(chain_of<2, double>(robot));
  const double m1 = 0.5;
  const double m2 = 2.0;
  const Vector<2, double> q(0.4, -0.7);
  const double c2 = std::cos(q[1]);
  const Matrix<2, 2, double> mass = mass_matrix(model, q);
  EXPECT_NEAR(mass(0, 0), m1 + m2 * (2 + 2 * c2), 1e-12);
  EXPECT_NEAR(mass(0, 1), m2 * (1 + c2), 1e-12);
  EXPECT_NEAR(mass(1, 1), m2, 1e-12);
  const Vector<2, double> zero = Vector<2, double>::Zero();
  const Vector<2, double> gravity = inverse_dynamics(model, q, zero, zero, 0.0);
  const double g = 9.81;
  EXPECT_NEAR(gravity[1], m2 * g * std::cos(q[0] + q[1]), 1e-12);
  EXPECT_NEAR(gravity[0], (m1 + m2) * g * std::cos(q[0]) + m2 * g * std::cos(q[0] + q[1]), 1e-12);
}

TEST(Robots, TwoLinkHasTheSettingsOfThePaper) {
  const RobotDescription robot = read_robot_file(kRobots / "two_link.toml");
  EXPECT_TRUE(robot.effects.empty());
  for (const RobotJoint& joint : robot.joints) {
    EXPECT_EQ(joint.kp, 100);
    EXPECT_EQ(joint.kd, 20);
  }
  EXPECT_EQ(robot.estimator.alpha, 10);
  EXPECT_EQ(robot.estimator.hidden_units, 35);
  EXPECT_EQ(robot.estimator.learning_rate, 2.5);
  EXPECT_EQ(robot.estimator.weight_radius, 10);
  const auto bound = bound_of<2, double>(robot.bound.value());
  const Vector<2, double> zero = Vector<2, double>::Zero();
  EXPECT_DOUBLE_EQ(evaluate(bound, zero, {0.3, -0.5}, zero), 4.4 * (0.6 + 3.0 + 1.0));
}

TEST(Robots, EmpsIsItsMassAloneWithoutGravity) {
  const RobotDescription robot = read_robot_file(kRobots / "emps.toml");
  const auto model = make_model(chain_of<1, double>(robot));
  const Vector<1, double> q(0.1);
  const Vector<1, double> dq(0.2);
  const Vector<1, double> ddq(1.5);
  EXPECT_NEAR(inverse_dynamics(model, q, dq, ddq, 0.0)[0], 95.1089 * 1.5, 1e-10);
  ASSERT_TRUE(robot.channels);
  EXPECT_EQ(robot.channels->position[0].source, "qm");
  EXPECT_EQ(robot.channels->torque[0].scale_source, "gtau");
}

}  // namespace
}  // namespace offnominal::desk
