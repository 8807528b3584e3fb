#include "robot/joint_units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/error.hpp"
#include "support/places.hpp"

namespace offnominal::desk {
namespace {

using test::message_of;
using testing::HasSubstr;

RobotDescription joint_of(JointType type) {
  RobotDescription robot;
  robot.joints.emplace_back();
  robot.joints[0].joint.type = type;
  return robot;
}

// Position, velocity and torque of one joint in these units.
ChannelMap units(const std::string& position, const std::string& velocity,
                 const std::string& torque) {
  const auto channel = [](const std::string& name, const std::string& unit) {
    Channel one;
    one.source = name;
    one.unit = unit;
    return one;
  };
  ChannelMap channels;
  channels.position = {channel("q", position)};
  channels.velocity = {channel("dq", velocity)};
  channels.torque = {channel("tau", torque)};
  return channels;
}

std::string refusal(const ChannelMap& channels, JointType type) {
  return message_of<InputError>(
      [&] { check_units_of_joints(channels, joint_of(type), "log.csv"); });
}

TEST(UnitsOfJoints, AreThoseOfItsType) {
  check_units_of_joints(units("deg", "rpm", "mNm"), joint_of(JointType::kRevolute), "log.csv");
  check_units_of_joints(units("mm", "mm/s", "kN"), joint_of(JointType::kPrismatic), "log.csv");
  check_units_of_joints(units("", "", ""), joint_of(JointType::kPrismatic), "log.csv");
}

TEST(UnitsOfJoints, OfTheOtherTypeAreRefused) {
  EXPECT_THAT(refusal(units("mm", "", ""), JointType::kRevolute),
              HasSubstr("log.csv: position of joint 1, column q: found the unit mm"));
  EXPECT_THAT(refusal(units("", "m/s", ""), JointType::kRevolute), HasSubstr("velocity"));
  EXPECT_THAT(refusal(units("", "", "N"), JointType::kRevolute), HasSubstr("torque"));
  EXPECT_THAT(refusal(units("deg", "", ""), JointType::kPrismatic), HasSubstr("a unit of m,"));
  EXPECT_THAT(refusal(units("", "", "Nm"), JointType::kPrismatic), HasSubstr("a unit of N,"));
}

TEST(UnitsOfJoints, MayBeAnyWithAScaleOrOfAMotor) {
  ChannelMap scaled = units("deg", "", "");
  scaled.position[0].scale = 0.01;
  check_units_of_joints(scaled, joint_of(JointType::kPrismatic), "log.csv");
  ChannelMap of_motor = units("deg", "", "");
  of_motor.position_of = {ChannelOf::kMotor};
  check_units_of_joints(of_motor, joint_of(JointType::kPrismatic), "log.csv");
}

TEST(UnitsOfJoints, AreLookedAtInEveryTermOfASum) {
  ChannelMap channels = units("", "", "");
  channels.torque[0].source.clear();
  channels.torque[0].sum = {units("", "", "Nm").torque[0], units("", "", "N").torque[0]};
  EXPECT_THAT(refusal(channels, JointType::kRevolute), HasSubstr("the unit N of a joint"));
}

}  // namespace
}  // namespace offnominal::desk
