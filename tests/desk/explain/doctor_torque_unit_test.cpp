#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "explain/doctor.hpp"
#include "robot/payload.hpp"
#include "strangers_arm.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::optional<DataFault> torque_unit_in(const Log& log, const RobotDescription& robot) {
  for (DataFault& fault : examine(log, robot)) {
    if (fault.kind == DataFaultKind::kTorqueUnit) return fault;
  }
  return std::nullopt;
}

TEST(TorqueUnit, IsNamedWhereItFitsAllJoints) {
  for (const std::size_t joints : {2U, 6U}) {
    const test::StrangersArm arm(joints);
    const Log right = test::record(arm.real, {.duration_s = 20});
    EXPECT_FALSE(torque_unit_in(right, arm.file));
    for (const auto& [per_si, words] : {std::pair{1e3, "mN m"}, std::pair{-1e3, "mN m"},
                                        std::pair{1e2, "N cm"}, std::pair{1e6, "uN m"}}) {
      Log log = right;
      log.tau *= per_si;
      const auto fault = torque_unit_in(log, arm.file);
      ASSERT_TRUE(fault) << joints << " joints, " << per_si;
      EXPECT_NEAR(fault->size, per_si, 0.1 * std::abs(per_si));
      EXPECT_THAT(fault->words, AllOf(HasSubstr("on joint 2"), HasSubstr(words)));
      EXPECT_TRUE(spoils(*fault, RestsOn::kTorque));
    }
  }
}

// Currents, and torques of motors: every joint by its own factor, and no unit has it.
TEST(TorqueUnit, IsToldWithoutANameWhereEveryJointHasItsOwnFactor) {
  const test::StrangersArm arm(6);
  Log log = test::record(arm.real, {.duration_s = 20});
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    log.tau.col(joint) /= 40.0 + 20 * static_cast<double>(joint);
  }
  const auto fault = torque_unit_in(log, arm.file);
  ASSERT_TRUE(fault);
  EXPECT_NEAR(fault->size, 1.0 / 40, 0.1 / 40);
  EXPECT_THAT(fault->words, Not(HasSubstr("as in")));
  EXPECT_THAT(fault->mend, HasSubstr("torque_constant"));
}

// The lines to write turn the recording into what it should have been.
TEST(TorqueUnit, ComesWithTheChannelsThatMendIt) {
  const test::StrangersArm arm(2);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.tau *= -1e3;
  for (const char* joint : {"1", "2"}) {
    Channel channel;
    channel.source = std::string("q") + joint;
    log.channels.position.push_back(channel);
    channel.source = std::string("tau") + joint;
    log.channels.torque.push_back(channel);
  }
  const auto fault = torque_unit_in(log, arm.file);
  ASSERT_TRUE(fault);
  ASSERT_EQ(fault->channels.size(), 1U);
  EXPECT_THAT(fault->channels[0], HasSubstr("-0.001"));
}

// Two units at once: neither fits without the other.
TEST(TorqueUnit, IsNamedBesidePositionsInDegrees) {
  const test::StrangersArm arm(3);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.q *= 180 / std::numbers::pi;
  log.dq *= 180 / std::numbers::pi;
  log.tau *= 1e3;
  std::vector<DataFaultKind> kinds;
  for (const DataFault& fault : examine(log, arm.file)) kinds.push_back(fault.kind);
  EXPECT_THAT(kinds,
              ::testing::IsSupersetOf({DataFaultKind::kDegrees, DataFaultKind::kTorqueUnit}));
}

// Where the torques are next to nothing a model that weighs nothing misses the least.
TEST(TorqueUnit, OfTorquesThatAreTooSmallIsNoMatterOfDegrees) {
  const test::StrangersArm arm(3);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.tau /= 100;
  for (const DataFault& fault : examine(log, arm.file)) {
    EXPECT_NE(fault.kind, DataFaultKind::kDegrees) << fault.words;
  }
  EXPECT_TRUE(torque_unit_in(log, arm.file));
}

TEST(TorqueUnit, MayBeOverruledAsAllThatStopsAVerb) {
  const KeepFault keep = keep_fault_of("all:torque_unit");
  EXPECT_EQ(keep.kind, DataFaultKind::kTorqueUnit);
  EXPECT_EQ(keep.joint, -1);
  EXPECT_EQ(keep_fault_of("all:gravity").kind, DataFaultKind::kGravity);
  EXPECT_ANY_THROW(static_cast<void>(keep_fault_of("all:nothing_left")));
}

// A tool that outweighs the wrist, and a counterweight that carries nearly all of one joint, are
// no units: some joint beside them tells.
TEST(TorqueUnit, IsNoToolAndNoCounterweight) {
  test::StrangersArm tool(6);
  const RobotDescription with_tool = carrying(tool.real, Payload{8, {0.2, 0, 0}});
  EXPECT_FALSE(torque_unit_in(test::record(with_tool, {.duration_s = 20}), tool.file));
  test::StrangersArm balanced(4);
  Log log = test::record(balanced.real, {.duration_s = 20});
  log.tau.col(1) *= 0.05;
  EXPECT_FALSE(torque_unit_in(log, balanced.file));
}

std::vector<DataFault> torque_units_in(const Log& log, const RobotDescription& robot) {
  std::vector<DataFault> found;
  for (DataFault& fault : examine(log, robot)) {
    if (fault.kind == DataFaultKind::kTorqueUnit) found.push_back(std::move(fault));
  }
  return found;
}

// A small drive logs mN m beside large ones that log N m, or stands before its gear.
TEST(TorqueUnit, OfOneDriveIsNamedAtItsJoint) {
  const test::StrangersArm arm(6);
  const Log right = test::record(arm.real, {.duration_s = 20});
  // What turns about its own middle says nothing of its scale: the last one.
  for (Index joint = 1; joint < 5; ++joint) {
    for (const double factor : {1e3, -1e3, 100.0, 10.0, 0.01, 0.001}) {
      Log log = right;
      log.tau.col(joint) *= factor;
      const auto found = torque_units_in(log, arm.file);
      ASSERT_EQ(found.size(), 1U) << joint << ", " << factor;
      EXPECT_EQ(found[0].joint, joint);
      EXPECT_NEAR(found[0].size, factor, 0.2 * std::abs(factor));
      EXPECT_TRUE(spoils(found[0], RestsOn::kTorque));
      EXPECT_EQ(found[0].words.find("mN m") != std::string::npos, std::abs(factor) == 1e3);
    }
  }
}

TEST(TorqueUnit, OfAWristIsNamedAtItsJoints) {
  const test::StrangersArm arm(6);
  Log log = test::record(arm.real, {.duration_s = 20});
  log.tau.middleCols(3, 2) *= 1e3;
  const auto found = torque_units_in(log, arm.file);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].joint, 3);
  EXPECT_EQ(found[1].joint, 4);
  EXPECT_THAT(found[1].mend, HasSubstr("scale the torque of joint 5 by 0.001"));
}

// Masses that the file has wrong many times over are felt by the joints before as well; as is what
// lies further out than the file says, although that is next to nothing there.
TEST(TorqueUnit, OfOneDriveIsNoLinkThatTheFileHasWrong) {
  const test::StrangersArm arm(6);
  const Log log = test::record(arm.real, {.duration_s = 20});
  for (std::size_t first = 1; first < 5; ++first) {
    for (const double part : {0.1, 0.03, 0.01}) {
      RobotDescription lighter = arm.file;
      RobotDescription shorter = arm.file;
      for (std::size_t link = first; link < 6; ++link) {
        lighter.joints[link].joint.mass_kg *= part;
        for (double& along : shorter.joints[link].joint.centre_of_mass_m) along *= part;
      }
      EXPECT_THAT(torque_units_in(log, lighter), IsEmpty()) << first << ", " << part;
      EXPECT_THAT(torque_units_in(log, shorter), IsEmpty()) << first << ", " << part;
    }
  }
}

// What one joint alone has may be its mass: only far off is it a unit.
TEST(TorqueUnit, OfOneJointIsToldOnlyFarOff) {
  RobotDescription robot = test::serial_arm(1);
  robot.joints[0].joint.axis = {0, 1, 0};
  const Log right = test::record(robot, {.duration_s = 20});
  for (const auto& [factor, told] : {std::pair{10.0, false}, std::pair{0.1, false},
                                     std::pair{1000.0, true}, std::pair{0.01, true}}) {
    Log log = right;
    log.tau *= factor;
    EXPECT_EQ(torque_unit_in(log, robot).has_value(), told) << factor;
  }
}

// Without gravity a rotor that nobody wrote down is no unit.
TEST(TorqueUnit, IsNotToldByInertiaAndFriction) {
  const RobotDescription robot = test::serial_arm(1);
  RobotDescription real = robot;
  real.effects.push_back(test::effect_of(EffectKind::kRotorInertia, 0, {20}, true));
  EXPECT_FALSE(torque_unit_in(test::record(real, {.duration_s = 20}), robot));
}

}  // namespace
}  // namespace offnominal::desk
