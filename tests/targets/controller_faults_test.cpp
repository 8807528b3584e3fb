// What makes the joint controller safe, of every joint, at which limit.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <offnominal/controller/feedback_check.hpp>
#include <offnominal/controller/takeover.hpp>

#include "scripted_joints.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::BusMode;
using hal::ControllerState;
using hal::DriveMode;
using hal::SourceState;
using Config = ScriptedJoints::Controller::Config;

struct Cause {
  const char* name;
  void (*happens)(hal::JointFeedback& joint);
  Fault fault;
};
constexpr std::array<Cause, 6> kCauses{{
    {"encoder stale", [](auto& joint) { joint.encoder = SourceState::kStale; },
     Fault::kEncoderSilent},
    {"encoder in error", [](auto& joint) { joint.encoder = SourceState::kError; },
     Fault::kEncoderUntrusted},
    {"drive stale", [](auto& joint) { joint.drive = SourceState::kStale; }, Fault::kDriveSilent},
    {"drive in error", [](auto& joint) { joint.drive = SourceState::kError; },
     Fault::kDriveUntrusted},
    {"drive's fault", [](auto& joint) { joint.status.flags = hal::kDriveFault; },
     Fault::kDriveReported},
    {"encoder's fault", [](auto& joint) { joint.status.flags = hal::kEncoderFault; },
     Fault::kDriveReported},
}};

TEST(ControllerFaults, EveryCauseAtEveryJointIsNamedPassiveAndArmed) {
  for (const Cause& cause : kCauses) {
    for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
      for (const bool armed : {false, true}) {
        ScriptedJoints arm;
        arm.become_passive();
        ASSERT_TRUE(!armed || arm.start());
        cause.happens(arm.drives.joints[j]);
        arm.tick();
        EXPECT_EQ(arm.state(), ControllerState::kFault) << cause.name << ", joint " << j;
        EXPECT_EQ(arm.fault(), cause.fault) << cause.name << ", joint " << j;
      }
    }
  }
}

// In kInit nothing moves: it waits until the cause is gone.
TEST(ControllerFaults, NoneButAStopInInit) {
  for (const Cause& cause : kCauses) {
    ScriptedJoints arm;
    arm.be_heard();
    cause.happens(arm.drives.joints[1]);
    arm.run(5);
    EXPECT_EQ(arm.state(), ControllerState::kInit) << cause.name;
    EXPECT_EQ(arm.fault(), Fault::kNone) << cause.name;
    arm.drives.stop = true;
    arm.tick();
    EXPECT_EQ(arm.fault(), Fault::kEmergencyStop) << cause.name;
  }
}

TEST(ControllerFaults, ADriveMayBeLimitedOrHaveMissedACommand) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  for (hal::JointFeedback& joint : arm.drives.joints) {
    joint.status.flags = hal::kTorqueLimited | hal::kCommandMissing;
  }
  arm.run(5);
  EXPECT_EQ(arm.state(), ControllerState::kArmed);
}

TEST(ControllerFaults, ABusThatTakesNoPartIsLost) {
  for (const BusMode mode : {BusMode::kOff, BusMode::kDown}) {
    ScriptedJoints arm;
    ASSERT_TRUE(arm.start());
    arm.bus.mode = mode;
    arm.tick();
    EXPECT_EQ(arm.fault(), Fault::kBusLost);
  }
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  for (const BusMode mode : {BusMode::kWarning, BusMode::kPassive}) {
    arm.bus.mode = mode;
    arm.run(3);
    EXPECT_EQ(arm.state(), ControllerState::kArmed);
  }
}

TEST(ControllerFaults, LateTicksInARowAreBorneUpToTheirLimit) {
  for (const int allowed : {0, 1, 3, 10, 255}) {
    Config config = ScriptedJoints::default_config();
    config.late_ticks_allowed = static_cast<std::uint8_t>(allowed);
    ScriptedJoints arm(config);
    ASSERT_TRUE(arm.start());
    for (int i = 0; i < allowed; ++i) arm.tick(1);
    EXPECT_EQ(arm.state(), ControllerState::kArmed) << allowed;
    arm.tick();
    EXPECT_EQ(arm.data->late_in_a_row, 0) << "one in time";
    for (int i = 0; i < allowed; ++i) arm.tick(1);
    EXPECT_EQ(arm.state(), ControllerState::kArmed) << allowed;
    EXPECT_EQ(arm.data->late_in_a_row, allowed);
    arm.tick(1);
    EXPECT_EQ(arm.fault(), Fault::kOverrun) << allowed;
    EXPECT_EQ(arm.data->overruns, static_cast<std::uint32_t>(2 * allowed + 1))
        << "one a tick that began late, however late";
  }
}

// Four periods at once are as long as four late ticks: an armed arm was alone for all of them.
TEST(ControllerFaults, OneTickThatIsLaterThanThatIsAFaultWhereItIsArmed) {
  for (const std::uint32_t too_late : {4U, 7999U, 0xFFFFFFFFU}) {
    ScriptedJoints arm;
    ASSERT_TRUE(arm.start());
    arm.tick(3);
    EXPECT_EQ(arm.state(), ControllerState::kArmed);
    arm.tick();
    arm.tick(too_late);
    EXPECT_EQ(arm.fault(), Fault::kOverrun) << too_late;
    EXPECT_TRUE(arm.all_commanded(DriveMode::kOff));
    ScriptedJoints passive;
    passive.become_passive();
    passive.tick(too_late);
    EXPECT_EQ(passive.state(), ControllerState::kPassive) << too_late;
  }
}

// GIVEN more late ticks than their counter can hold WHEN all is well but for that THEN the
// controller does not take them for none.
TEST(ControllerFaults, NoNumberOfLateTicksIsTakenForNone) {
  ScriptedJoints arm;
  for (int i = 1; i <= 70'000; ++i) {
    if (i == 10) arm.be_heard();
    arm.tick(1);
    ASSERT_EQ(arm.data->late_in_a_row, std::min(i, 65'535));
    ASSERT_EQ(arm.state(), ControllerState::kInit) << i;
  }
  EXPECT_EQ(arm.data->overruns, 70'000U);
  arm.tick();
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
}

// A drive that was in torque mode before anybody told it so has not followed.
TEST(ControllerFaults, WhoFollowsHasBeenTold) {
  ScriptedJoints arm;
  arm.follows.fill(false);
  for (hal::JointFeedback& joint : arm.drives.joints) joint.status.mode = DriveMode::kTorque;
  arm.become_passive();
  ASSERT_TRUE(arm.arm());
  arm.tick();
  EXPECT_FALSE(arm.data->drives_follow);
  arm.tick();
  EXPECT_TRUE(arm.data->drives_follow);
}

// From arming on it has time_to_follow_us and what a change of its mode may stay unseen.
TEST(ControllerFaults, ADriveHasItsTimeToFollowAndNoMore) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    Config config = ScriptedJoints::default_config();
    config.time_to_follow_us = 6000;
    ScriptedJoints arm(config);
    arm.drives.max_age_us = 4000;
    arm.become_passive();
    arm.follows[j] = false;
    ASSERT_TRUE(arm.arm());
    // Judged before it is counted: the eleventh tick has seen ten periods, the twelfth eleven.
    arm.run(11);
    EXPECT_EQ(arm.state(), ControllerState::kArmed);
    EXPECT_EQ(arm.data->waiting_ticks, 11U);
    EXPECT_EQ(arm.data->run_ticks, 0U);
    EXPECT_FALSE(arm.data->drives_follow);
    arm.tick();
    EXPECT_EQ(arm.fault(), Fault::kDriveNotFollowing);
  }
}

// A period is as long as it is: ten of them are longer than 9999 us.
TEST(ControllerFaults, TimeToFollowIsMeasuredInWholePeriods) {
  Config config = ScriptedJoints::default_config();
  config.time_to_follow_us = 5999;
  ScriptedJoints arm(config);
  arm.drives.max_age_us = 4000;
  arm.become_passive();
  arm.follows[0] = false;
  ASSERT_TRUE(arm.arm());
  arm.run(10);
  EXPECT_EQ(arm.state(), ControllerState::kArmed);
  arm.tick();
  EXPECT_EQ(arm.fault(), Fault::kDriveNotFollowing);
}

TEST(ControllerFaults, TimeToFollowPassesInLateTicksToo) {
  Config config = ScriptedJoints::default_config();
  config.late_ticks_allowed = 10;
  config.time_to_follow_us = 6000;
  ScriptedJoints arm(config);
  arm.drives.max_age_us = 4000;
  arm.become_passive();
  arm.follows[0] = false;
  ASSERT_TRUE(arm.arm());
  arm.tick(10);
  EXPECT_EQ(arm.data->waiting_ticks, 11U);
  EXPECT_EQ(arm.state(), ControllerState::kArmed);
  arm.tick();
  EXPECT_EQ(arm.fault(), Fault::kDriveNotFollowing);
}

// As long as the slowest joint's torque takes from one limit to the other, and ramp_s: here 0.5 s.
TEST(ControllerFaults, AnArmHasItsTimeToBeHeldAndNoMore) {
  for (std::size_t slow = 0; slow < ScriptedJoints::kJoints; ++slow) {
    Config config = ScriptedJoints::default_config();
    config.time_to_follow_us = 6000;
    config.arming.ramp_s = 0.25;
    config.arming.torque_rate[slow] = ScriptedJoints::kMaxTorque / 0.125;
    config.arming.torque_rate[1 - slow] = ScriptedJoints::kMaxTorque / 0.0625;
    ScriptedJoints arm(config);
    arm.drives.max_age_us = 4000;
    arm.become_passive();
    ASSERT_TRUE(arm.arm());
    arm.tick();
    arm.drives.joints[0].reading.velocity = 1.5F;
    // Judged before it is counted, as above.
    arm.run(510);
    EXPECT_EQ(arm.state(), ControllerState::kArmed);
    EXPECT_EQ(arm.data->waiting_ticks, 511U);
    arm.tick();
    EXPECT_EQ(arm.fault(), Fault::kArmNotHeld);
  }
}

TEST(ControllerFaults, EveryJointHasToStayWhereItWasUntilTimeBegins) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    for (const float sign : {-1.0F, 1.0F}) {
      Config config = ScriptedJoints::default_config();
      config.arming.position_window.fill(0.05);
      ScriptedJoints arm(config);
      arm.become_passive();
      arm.follows.fill(false);
      ASSERT_TRUE(arm.arm());
      arm.tick();
      arm.drives.joints[j].reading.position = sign * 0.049F;
      arm.tick();
      EXPECT_EQ(arm.state(), ControllerState::kArmed);
      arm.drives.joints[j].reading.position = sign * 0.051F;
      arm.tick();
      EXPECT_EQ(arm.fault(), Fault::kArmNotHeld) << j;
    }
  }
}

TEST(ControllerFaults, EveryJointHasToRestBeforeTimeBegins) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    ScriptedJoints arm;
    arm.become_passive();
    ASSERT_TRUE(arm.arm());
    arm.tick();
    arm.drives.joints[j].reading.velocity = 1.01F;
    arm.run(10);
    EXPECT_EQ(arm.state(), ControllerState::kArmed);
    EXPECT_FALSE(arm.data->drives_follow) << j;
    arm.drives.joints[j].reading.velocity = 0.99F;
    arm.run(2);
    EXPECT_TRUE(arm.data->drives_follow);
  }
}

TEST(ControllerFaults, ADriveThatFallsBackIsNotFollowingAtOnce) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    for (const DriveMode mode : {DriveMode::kOff, DriveMode::kDamping}) {
      ScriptedJoints arm;
      ASSERT_TRUE(arm.start());
      arm.follows[j] = false;
      arm.drives.joints[j].status.mode = mode;
      arm.tick();
      EXPECT_EQ(arm.fault(), Fault::kDriveNotFollowing);
    }
  }
}

TEST(ControllerFaults, WhoIsNotArmedNeedNotFollow) {
  ScriptedJoints arm;
  arm.become_passive();
  arm.run(500);
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
  arm.follows.fill(false);
  arm.drives.joints[0].status.mode = DriveMode::kTorque;
  arm.run(500);
  EXPECT_EQ(arm.state(), ControllerState::kPassive);
}

}  // namespace
}  // namespace offnominal::test
