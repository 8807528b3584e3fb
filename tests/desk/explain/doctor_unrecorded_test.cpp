#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "explain/doctor.hpp"
#include "explain/treatment.hpp"
#include "log/log.hpp"
#include "serial_arm.hpp"

// Torques that nobody recorded, and those that are one value because the drive gives none.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> named(const std::vector<DataFault>& faults) {
  std::vector<std::string> names;
  for (const DataFault& fault : faults) {
    names.push_back(std::string(name_of(fault.kind)) + " " + std::to_string(fault.joint + 1));
  }
  return names;
}

// GIVEN torques of zero, or of any one value, WHEN the arm moves THEN every joint is named, nothing
// of the recording is left, and no answer is given from it.
TEST(UnrecordedTorque, OfEveryJointLeavesNothingOfTheRecording) {
  const RobotDescription robot = test::serial_arm(3);
  for (const double value : {0.0, 7.25}) {
    Log log = test::record(robot, {.duration_s = 20});
    log.tau.setConstant(value);
    const std::vector<DataFault> faults = treat(log, robot);
    EXPECT_THAT(named(faults), ElementsAre("stuck 1", "stuck 2", "stuck 3", "nothing_left 0"));
    EXPECT_THAT(faults[0].words, AllOf(HasSubstr("joint 1 was never recorded"), HasSubstr("rad")));
    EXPECT_TRUE(spoils(faults.back(), RestsOn::kTorque));
  }
}

// GIVEN one such column of several THEN its joint alone goes without an answer, and what else is
// wrong with the recording is still found.
TEST(UnrecordedTorque, OfOneJointLeavesTheOthers) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20});
  log.tau.col(1).setZero();
  Log turned = log;
  const std::vector<DataFault> faults = treat(log, robot);
  ASSERT_THAT(named(faults), ElementsAre("stuck 2", "nothing_left 2"));
  EXPECT_THAT(faults[0].left_out_of, ElementsAre(1));
  EXPECT_FALSE(spoils(faults.back(), RestsOn::kTorque));
  turned.tau.col(2) *= -1;
  EXPECT_THAT(named(examine(turned, robot)), ElementsAre("stuck 2", "torque_sign 3"));
}

TEST(UnrecordedTorque, IsNoneOfAJointThatRests) {
  const RobotDescription robot = test::serial_arm(3);
  Log log = test::record(robot, {.duration_s = 20});
  log.q.col(2).setConstant(0.3);
  log.dq.col(2).setZero();
  log.tau.col(2).setZero();
  EXPECT_THAT(named(examine(log, robot)), IsEmpty());
}

// A joint whose drive is off, and what moves it is what the model says: q'' from gravity, friction
// and a torque that stays.
Log free_motion(const RobotDescription& robot, double torque_nm, double friction_nm_s) {
  const RobotJoint& one = robot.joints.front();
  const double arm = one.joint.mass_kg * one.joint.centre_of_mass_m[0];
  const double inertia = one.joint.inertia_kg_m2[2] + arm * one.joint.centre_of_mass_m[0];
  const double weight = -arm * robot.gravity_m_s2[1];
  Log log;
  log.period_s = 0.002;
  constexpr Index kRows = 5000;
  log.t_s = Eigen::VectorXd::LinSpaced(kRows, 0, log.period_s * (kRows - 1));
  log.q.resize(kRows, 1);
  log.dq.resize(kRows, 1);
  log.tau = Eigen::MatrixXd::Constant(kRows, 1, torque_nm);
  log.dq_derived = {false};
  double q = -1.0;
  double dq = 0;
  constexpr int kSteps = 20;
  for (Index row = 0; row < kRows; ++row) {
    log.q(row, 0) = q;
    log.dq(row, 0) = dq;
    for (int step = 0; step < kSteps; ++step) {
      const double dt = log.period_s / kSteps;
      dq += dt * (torque_nm - friction_nm_s * dq - weight * std::cos(q)) / inertia;
      q += dt * dq;
    }
  }
  return log;
}

RobotDescription pendulum(double gravity_m_s2) {
  RobotDescription robot = test::serial_arm(1);
  robot.gravity_m_s2 = {0, -gravity_m_s2, 0};
  robot.joints.front().joint.centre_of_mass_m = {0.2, 0, 0};
  return robot;
}

TEST(UnrecordedTorque, IsNoneOfAJointThatSwingsWithItsDriveOff) {
  const RobotDescription robot = pendulum(9.81);
  const Log log = free_motion(robot, 0, 0.05);
  EXPECT_GT(log.q.maxCoeff() - log.q.minCoeff(), 0.5);
  EXPECT_THAT(named(examine(log, robot)), IsEmpty());
}

// GIVEN a joint without a drive beside one that holds still WHEN it swings THEN it is left out: a
// link without mass would explain it best.
TEST(UnrecordedTorque, IsThatOfAJointWithoutADriveBesideOthers) {
  RobotDescription robot = pendulum(9.81);
  robot.joints.push_back(robot.joints.front());
  robot.joints.back().name = "free";
  const Log swing = free_motion(pendulum(9.81), 0, 0.05);
  Log log = swing;
  const Index rows = swing.sample_count();
  log.dq_derived = {false, false};
  log.q.resize(rows, 2);
  log.q << Eigen::VectorXd::Zero(rows), swing.q;
  log.dq.resize(rows, 2);
  log.dq << Eigen::VectorXd::Zero(rows), swing.dq;
  log.tau.resize(rows, 2);
  log.tau << 5 + swing.q.col(0).array().cos(), Eigen::VectorXd::Zero(rows);
  const std::vector<DataFault> faults = examine(log, robot);
  ASSERT_THAT(named(faults), ElementsAre("stuck 2"));
  EXPECT_THAT(faults.front().words, HasSubstr("never recorded, or it has no drive"));
  EXPECT_THAT(faults.front().mend, HasSubstr("--keep 2:stuck"));
  // Where no torque changes at all, the drives are off.
  log.tau.setZero();
  EXPECT_THAT(named(examine(log, robot)), IsEmpty());
}

// A motor that runs up under a torque that it is told: what its file lacks may be friction.
TEST(UnrecordedTorque, IsNoneOfAJointThatRunsUpUnderAConstantOne) {
  const RobotDescription robot = pendulum(0);
  EXPECT_THAT(named(examine(free_motion(robot, 1, 0.1), robot)), IsEmpty());
}

}  // namespace
}  // namespace offnominal::desk
