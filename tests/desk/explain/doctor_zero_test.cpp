#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "explain/doctor.hpp"
#include "serial_arm.hpp"

// Positions that are counted from another zero than the robot file's, or the other way round.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::size_t kJoints = 5;

Log recorded(const RobotDescription& robot) { return test::record(robot, {.duration_s = 15}); }

void turn(Log& log, Index joint) {
  log.q.col(joint) *= -1;
  log.dq.col(joint) *= -1;
}

TEST(JointZero, OfOneJointIsNamedWithItsAngle) {
  const RobotDescription robot = test::serial_arm(kJoints);
  for (const double angle : {0.4, -1.2, std::numbers::pi}) {
    Log log = recorded(robot);
    log.q.col(1).array() -= angle;
    const auto faults = examine(log, robot);
    ASSERT_THAT(faults, SizeIs(1)) << angle;
    EXPECT_EQ(faults[0].kind, DataFaultKind::kJointZero) << faults[0].words;
    EXPECT_EQ(faults[0].joint, 1);
    EXPECT_TRUE(faults[0].certain);
    EXPECT_NEAR(std::remainder(faults[0].size - angle, 2 * std::numbers::pi), 0, 0.01);
  }
}

TEST(JointZero, OfAJointThatIsCountedTheOtherWayRoundIsNamed) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  turn(log, 1);
  const auto faults = examine(log, robot);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_EQ(faults[0].kind, DataFaultKind::kJointZero) << faults[0].words;
  EXPECT_THAT(faults[0].words, HasSubstr("those of joint 2 turned about, the model"));
}

TEST(JointZero, OfSeveralJointsIsNamedJointByJoint) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  log.q.col(1).array() += std::numbers::pi / 2;
  turn(log, 3);
  log.tau.col(3) *= -1;
  log.q.col(3).array() += 0.7;
  const auto faults = examine(log, robot);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_EQ(faults[0].kind, DataFaultKind::kJointZero);
  EXPECT_EQ(faults[0].joint, -1);
  EXPECT_THAT(faults[0].words, AllOf(HasSubstr("those of joint 2 and 1.5"), HasSubstr("taken off"),
                                     HasSubstr("joint 4 turned about, as its torques,")));
}

// What another model would explain as well is no fault of the recording.
TEST(JointZero, IsNotMadeOfAPayloadASpringOrAHeavyLink) {
  const RobotDescription file = test::serial_arm(kJoints);
  std::vector<RobotDescription> reals(3, file);
  reals[0].effects.push_back(
      test::effect_of(EffectKind::kTipPayload, kJoints - 1, {3.0, 0.1, 0.05, 0.1}));
  reals[1].effects.push_back(test::effect_of(EffectKind::kJointStiffness, 1, {8.0, 0.5}));
  reals[2].joints[2].joint.mass_kg *= 1.6;
  for (const RobotDescription& real : reals) {
    EXPECT_THAT(examine(recorded(real), file), IsEmpty());
  }
}

// Of the last joint both turn the first moment about; a payload has a mass besides.
TEST(JointZero, OfTheLastJointIsToldFromAPayloadByItsMass) {
  const RobotDescription file = test::serial_arm(kJoints);
  const auto& last = file.joints.back().joint;
  constexpr double kMass = 0.5;  // kg
  const double turns = -2 * last.mass_kg / kMass;
  RobotDescription real = file;
  real.effects.push_back(test::effect_of(
      EffectKind::kTipPayload, kJoints - 1,
      {kMass, turns * last.centre_of_mass_m[0], turns * last.centre_of_mass_m[1], 0}));
  for (const DataFault& fault : examine(recorded(real), file)) {
    EXPECT_TRUE(fault.or_masses) << fault.words;
  }
  Log log = recorded(file);
  log.q.col(kJoints - 1).array() -= std::numbers::pi;
  const auto faults = examine(log, file);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_EQ(faults[0].kind, DataFaultKind::kJointZero) << faults[0].words;
  EXPECT_EQ(faults[0].joint, kJoints - 1);
  EXPECT_FALSE(faults[0].or_masses) << faults[0].words;
}

// Their model turned upside down says nearly the same.
TEST(JointZero, IsNotMadeOfTorquesOfTheWrongSign) {
  for (const std::size_t joints : {1U, 3U}) {
    const RobotDescription robot = test::serial_arm(joints);
    Log log = recorded(robot);
    log.tau *= -1;
    const auto faults = examine(log, robot);
    ASSERT_THAT(faults, Not(IsEmpty()));
    for (const DataFault& fault : faults) {
      EXPECT_EQ(fault.kind, DataFaultKind::kTorqueSign) << fault.words;
    }
  }
}

TEST(JointZero, OfAnArmWhoseFileHasAPayloadIsNamed) {
  RobotDescription robot = test::serial_arm(kJoints);
  robot.effects.push_back(
      test::effect_of(EffectKind::kTipPayload, kJoints - 1, {3.0, 0.1, 0.05, 0.1}));
  Log log = recorded(robot);
  log.q.col(1).array() -= 0.4;
  const auto faults = examine(log, robot);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_EQ(faults[0].kind, DataFaultKind::kJointZero) << faults[0].words;
  EXPECT_NEAR(faults[0].size, 0.4, 0.01);
}

// The sum's terms stand as they are: scale and offset are of what they come to.
TEST(JointZero, IsMendedByLinesOfChannels) {
  const RobotDescription robot = test::serial_arm(kJoints);
  Log log = recorded(robot);
  for (const char* quantity : {"q", "tau"}) {
    for (std::size_t joint = 1; joint <= kJoints; ++joint) {
      Channel channel;
      channel.source = quantity + std::to_string(joint);
      (*quantity == 'q' ? log.channels.position : log.channels.torque).push_back(channel);
    }
  }
  Channel& second = log.channels.position[1];
  second.sum = {second, second};
  second.source = "";
  turn(log, 1);
  const auto faults = examine(log, robot);
  ASSERT_THAT(faults, SizeIs(1));
  ASSERT_THAT(faults[0].channels, Not(IsEmpty()));
  EXPECT_THAT(faults[0].channels[0],
              HasSubstr("{sum = [{source = \"q2\"}, {source = \"q2\"}], scale = -1"));
}

// Of one joint or two a centre of mass elsewhere looks the same: said, and nothing refused for it.
TEST(JointZero, OfFewJointsIsUnsure) {
  const RobotDescription robot = test::serial_arm(2);
  Log log = recorded(robot);
  log.q.col(1).array() -= 0.8;
  const auto faults = examine(log, robot);
  ASSERT_THAT(faults, SizeIs(1));
  EXPECT_EQ(faults[0].kind, DataFaultKind::kJointZero);
  EXPECT_FALSE(faults[0].certain);
  EXPECT_THAT(faults[0].words, HasSubstr("may be counted"));
}

}  // namespace
}  // namespace offnominal::desk
