#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "compare/inverse_model.hpp"
#include "explain/doctor.hpp"
#include "explain/treatment.hpp"
#include "robot/payload.hpp"
#include "serial_arm.hpp"
#include "strangers_arm.hpp"

// Columns that stand at another joint than they are of.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

MatrixXd in_order(const MatrixXd& columns, const std::vector<Index>& order) {
  MatrixXd moved(columns.rows(), columns.cols());
  for (Index joint = 0; joint < columns.cols(); ++joint) {
    moved.col(joint) = columns.col(order[static_cast<std::size_t>(joint)]);
  }
  return moved;
}

Log in_order(Log log, const std::vector<Index>& order) {
  log.q = in_order(log.q, order);
  log.dq = in_order(log.dq, order);
  log.tau = in_order(log.tau, order);
  return log;
}

std::optional<DataFault> order_in(const Log& log, const RobotDescription& robot) {
  for (DataFault& fault : examine(log, robot)) {
    if (fault.kind == DataFaultKind::kJointOrder) return fault;
  }
  return std::nullopt;
}

TEST(JointOrder, OfTorquesIsNamedWithEveryJointThatHasAnothers) {
  for (const std::size_t joints : {2U, 6U}) {
    const test::StrangersArm arm(joints);
    Log log = test::record(arm.real, {.duration_s = 20});
    EXPECT_FALSE(order_in(log, arm.file));
    log.tau.col(0).swap(log.tau.col(1));
    const auto faults = examine(log, arm.file);
    ASSERT_THAT(faults, SizeIs(1)) << joints;
    EXPECT_EQ(faults[0].kind, DataFaultKind::kJointOrder);
    EXPECT_EQ(faults[0].signal, FaultySignal::kTorque);
    EXPECT_THAT(faults[0].words,
                AllOf(HasSubstr("what belongs to joint 1 stands at joint 2"),
                      HasSubstr("joint 2 stands at joint 1"), HasSubstr("the torques are")));
    EXPECT_TRUE(spoils(faults[0], RestsOn::kTorque));
  }
}

TEST(JointOrder, OfAllTorquesIsNamedWhateverItIs) {
  const test::StrangersArm arm(4);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.tau = in_order(log.tau, {2, 3, 1, 0});
  const auto fault = order_in(log, arm.file);
  ASSERT_TRUE(fault);
  EXPECT_THAT(
      fault->words,
      AllOf(HasSubstr("joint 1 stands at joint 4"), HasSubstr("joint 2 stands at joint 3"),
            HasSubstr("joint 3 stands at joint 1"), HasSubstr("joint 4 stands at joint 2")));
}

// Joints that are named otherwise than the file has them: two exchanged, from the tip, from the
// second.
TEST(JointOrder, OfAllColumnsIsNamed) {
  const test::StrangersArm arm(4);
  const Log log = test::record(arm.real, {.duration_s = 20});
  for (const std::vector<Index>& order :
       {std::vector<Index>{0, 2, 1, 3}, {3, 2, 1, 0}, {1, 2, 3, 0}}) {
    const auto faults = examine(in_order(log, order), arm.file);
    ASSERT_THAT(faults, SizeIs(1));
    EXPECT_EQ(faults[0].kind, DataFaultKind::kJointOrder);
    EXPECT_EQ(faults[0].signal, FaultySignal::kWhole);
    for (std::size_t joint = 0; joint < order.size(); ++joint) {
      if (order[joint] == static_cast<Index>(joint)) continue;
      EXPECT_THAT(faults[0].words,
                  HasSubstr("what belongs to joint " + std::to_string(order[joint] + 1) +
                            " stands at joint " + std::to_string(joint + 1)));
    }
  }
}

TEST(JointOrder, ComesWithTheChannelsThatMendIt) {
  const test::StrangersArm arm(2);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.tau.col(0).swap(log.tau.col(1));
  for (const char* joint : {"1", "2"}) {
    Channel channel;
    channel.source = std::string("q") + joint;
    log.channels.position.push_back(channel);
    channel.source = std::string("tau") + joint;
    log.channels.torque.push_back(channel);
  }
  const auto fault = order_in(log, arm.file);
  ASSERT_TRUE(fault);
  ASSERT_THAT(fault->channels, SizeIs(1));
  EXPECT_LT(fault->channels[0].find("tau2"), fault->channels[0].find("tau1"));
}

// What else makes every joint's model fail: none of it is in another order.
TEST(JointOrder, IsNotNamedForOtherFaults) {
  const test::StrangersArm arm(6);
  const Log right = test::record(arm.real, {.duration_s = 20});
  Log log = right;
  log.tau *= -1;
  EXPECT_FALSE(order_in(log, arm.file));
  log.tau = 1e3 * right.tau;
  EXPECT_FALSE(order_in(log, arm.file));
  log.tau = right.tau.rowwise().reverse().colwise().reverse();  // of another time as well
  EXPECT_FALSE(order_in(log, arm.file));
  RobotDescription mounted = arm.file;
  mounted.gravity_m_s2 = {9.81, 0, 0};
  EXPECT_FALSE(order_in(right, mounted));
  EXPECT_FALSE(order_in(
      test::record(carrying(arm.real, Payload{8, {0.2, 0, 0.1}}), {.duration_s = 20}), arm.file));
}

// GIVEN two joints whose torques are opposed to each other WHEN every sign is turned THEN it is the
// signs; WHEN they are exchanged THEN it is the order.
TEST(JointOrder, OfOpposedTorquesIsToldFromTurnedSigns) {
  RobotDescription robot = test::serial_arm(2);
  robot.gravity_m_s2 = {0, -9.81, 0};
  for (std::size_t joint = 0; joint < 2; ++joint) {
    Joint<double>& one = robot.joints[joint].joint;
    one.axis = {0, 0, 1};
    one.origin_m = {0, 0, 0};
    one.mass_kg = joint == 0 ? 8 : 3;
    one.centre_of_mass_m = {joint == 0 ? 0.3 : -0.3, joint == 0 ? 0.0 : 0.02, 0};
  }
  Log log = test::record(robot, {.duration_s = 20});
  const Eigen::ArrayXd t = log.t_s.array();
  log.q << (0.8 * t).sin(), 0.3 * (1.3 * t).sin();
  log.dq << 0.8 * (0.8 * t).cos(), 0.39 * (1.3 * t).cos();
  Eigen::MatrixXd ddq(log.q.rows(), 2);
  ddq << -0.64 * (0.8 * t).sin(), -0.507 * (1.3 * t).sin();
  log.tau = model_torque(robot, {log.t_s, log.q, log.dq, ddq});
  const Eigen::MatrixXd right = log.tau;
  ASSERT_LT(right.col(0).dot(right.col(1)), -0.8 * right.col(0).norm() * right.col(1).norm());
  EXPECT_FALSE(order_in(log, robot));
  log.tau = -right;
  EXPECT_FALSE(order_in(log, robot));
  const auto faults = examine(log, robot);
  ASSERT_FALSE(faults.empty());
  EXPECT_EQ(faults[0].kind, DataFaultKind::kTorqueSign);
  log.tau = right;
  log.tau.col(0).swap(log.tau.col(1));
  EXPECT_TRUE(order_in(log, robot));
}

TEST(JointOrder, MayBeOverruledAsAllThatStopsAVerb) {
  const test::StrangersArm arm(2);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.tau.col(0).swap(log.tau.col(1));
  const std::vector<DataFault> faults = treat(log, arm.file, {keep_fault_of("all:joint_order")});
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_TRUE(faults[0].overruled);
}

}  // namespace
}  // namespace offnominal::desk
