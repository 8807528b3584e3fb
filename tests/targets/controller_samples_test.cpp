// What the joint controller takes of what comes in, and what it counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <offnominal/controller/feedback_check.hpp>
#include <offnominal/controller/sample_taker.hpp>
#include <vector>

#include "scripted_joints.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;
using hal::SourceState;
using Config = ScriptedJoints::Controller::Config;

TEST(ControllerSamples, FramesWithSomethingWrongInThemAreCounted) {
  ScriptedJoints arm;
  arm.drives.answers = {
      hal::Status::kOk,           hal::Status::kUnknownId,      hal::Status::kNotSynchronised,
      hal::Status::kWrongCrc,     hal::Status::kSkippedCounter, hal::Status::kRepeatedCounter,
      hal::Status::kWrongLength,  hal::Status::kInvalidValue,   hal::Status::kWrongFormat,
      hal::Status::kNotADataFrame};
  arm.bus.waiting = arm.drives.answers.size();
  arm.tick();
  EXPECT_EQ(arm.drives.taken, arm.drives.answers.size());
  EXPECT_EQ(arm.data->refused_frames, 7U);
}

// All that has come is taken in the tick, but no more than 256 frames: a node that babbles does not
// keep the controller busy.
TEST(ControllerSamples, OneTickTakesWhatHasComeUpToAnEnd) {
  for (const std::size_t waiting : {0U, 1U, 3U, 4U, 5U, 8U, 255U, 256U}) {
    ScriptedJoints arm;
    arm.bus.waiting = waiting;
    arm.tick();
    EXPECT_EQ(arm.drives.taken, waiting);
    EXPECT_EQ(arm.bus.waiting, 0U);
    EXPECT_EQ(arm.bus.fetches, std::min<std::size_t>(waiting / 4 + 1, 64)) << waiting;
  }
  ScriptedJoints arm;
  arm.bus.waiting = 100'000;
  arm.tick();
  EXPECT_EQ(arm.drives.taken, 256U);
  arm.tick();
  EXPECT_EQ(arm.drives.taken, 512U);
}

TEST(ControllerSamples, JointsAreJudgedAtTheTicksBegin) {
  ScriptedJoints arm;
  arm.bus.time_us = 41'000;
  arm.tick();
  EXPECT_EQ(arm.drives.asked_at_us, 42'000);
}

TEST(ControllerSamples, HoldWhatEveryJointHasSent) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  arm.follows.fill(false);
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    const auto number = static_cast<float>(j + 1);
    arm.drives.joints[j].reading = {0.01F * number, 0.02F * number, true};
    arm.drives.joints[j].status.applied_torque = 0.5F * number;
  }
  arm.tick();
  EXPECT_TRUE(arm.data->fresh);
  for (Eigen::Index j = 0; j < 2; ++j) {
    const auto number = static_cast<float>(j + 1);
    EXPECT_EQ(arm.data->sample.q[j], static_cast<double>(0.01F * number));
    EXPECT_EQ(arm.data->sample.dq[j], static_cast<double>(0.02F * number));
    EXPECT_EQ(arm.data->sample.tau[j], static_cast<double>(0.5F * number));
  }
}

// GIVEN one joint of which nothing new has come WHEN the others are read THEN there is no sample:
// the torque is held, and time that nobody saw is counted.
TEST(ControllerSamples, AreOfEveryJointOrNone) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    ScriptedJoints arm;
    ASSERT_TRUE(arm.start());
    arm.run(5);
    const std::uint64_t run_ticks = arm.data->run_ticks;
    const auto commands = arm.drives.commands;
    arm.reads[j] = false;
    for (hal::JointFeedback& joint : arm.drives.joints) joint.reading.position = 0.01F;
    arm.tick();
    EXPECT_FALSE(arm.data->fresh);
    EXPECT_EQ(arm.data->missed_samples, 1U);
    EXPECT_EQ(arm.data->unseen_ticks, 1U);
    arm.tick(2);
    EXPECT_EQ(arm.data->missed_samples, 2U);
    EXPECT_EQ(arm.data->unseen_ticks, 4U);
    for (std::size_t i = 0; i < ScriptedJoints::kJoints; ++i) {
      EXPECT_EQ(arm.data->sample.q[static_cast<Eigen::Index>(i)], 0.0);
      EXPECT_EQ(arm.drives.commands[i].mode, DriveMode::kTorque);
      EXPECT_EQ(arm.drives.commands[i].torque, commands[i].torque);
    }
    arm.reads[j] = true;
    arm.tick();
    EXPECT_TRUE(arm.data->fresh);
    EXPECT_EQ(arm.data->unseen_ticks, 0U);
    EXPECT_EQ(arm.data->missed_samples, 2U);
    EXPECT_EQ(arm.data->run_ticks, run_ticks + 5);
    EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
  }
}

// Time that nobody saw may be long: it is never short again.
TEST(ControllerSamples, UnseenTimeDoesNotWrap) {
  ScriptedJoints arm;
  arm.become_passive();
  arm.reads.fill(false);
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint32_t>::max();
  arm.tick(kMost - 5);
  EXPECT_EQ(arm.data->unseen_ticks, kMost - 4);
  arm.tick(10);
  EXPECT_EQ(arm.data->unseen_ticks, kMost);
}

// A reading that is not valid is none, however new.
TEST(ControllerSamples, AreOfValidReadings) {
  ScriptedJoints arm;
  arm.be_heard();
  arm.drives.joints[0].encoder = SourceState::kNeverSeen;
  arm.tick();
  EXPECT_FALSE(arm.data->fresh);
  arm.drives.joints[0].encoder = SourceState::kValid;
  arm.tick();
  EXPECT_TRUE(arm.data->fresh);
  EXPECT_EQ(arm.data->missed_samples, 0U) << "of a run";
}

TEST(ControllerSamples, AreMissedOnlyInARun) {
  ScriptedJoints arm;
  arm.become_passive();
  arm.follows.fill(false);
  ASSERT_TRUE(arm.arm());
  arm.tick();
  arm.reads.fill(false);
  arm.tick();
  EXPECT_EQ(arm.data->missed_samples, 0U) << "the drives do not follow yet";
  arm.reads.fill(true);
  arm.follows.fill(true);
  arm.run(5);
  ASSERT_TRUE(arm.data->drives_follow);
  ASSERT_TRUE(arm.disarm());
  arm.reads.fill(false);
  arm.tick();
  EXPECT_EQ(arm.data->missed_samples, 0U) << "it has ended";
}

// While a controller is in kFault its encoders go on to be read: what they said until somebody
// cleared the fault is not what the joint does now.
TEST(ControllerSamples, VelocitiesAreObservedAnewAfterAFault) {
  ScriptedJoints arm;
  arm.become_passive();
  for (hal::JointFeedback& joint : arm.drives.joints) joint.reading.has_velocity = false;
  arm.run(100);
  EXPECT_EQ(arm.try_to_arm(), Fault::kNone);
  arm.stop(Fault::kEmergencyStop);
  for (const auto& observer : arm.data->motion) EXPECT_EQ(observer.observer.updates, 0U);
  arm.run(100);
  for (const auto& observer : arm.data->motion) EXPECT_EQ(observer.observer.updates, 100U);
  ASSERT_TRUE(arm.clear_fault());
  for (const auto& observer : arm.data->motion) EXPECT_EQ(observer.observer.updates, 0U);
  arm.tick();
  EXPECT_EQ(arm.try_to_arm(), Fault::kVelocityUnsettled);
}

TEST(ControllerSamples, LateTicksAreTicksOfTheRun) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  const std::uint64_t before = arm.data->run_ticks;
  arm.tick(3);
  EXPECT_EQ(arm.data->run_ticks, before + 4);
  EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
  EXPECT_EQ(arm.data->unseen_ticks, 0U);
  arm.tick();
  EXPECT_EQ(arm.data->run_ticks, before + 5);
  EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
}

// Each joint has an observer of its own, which runs at the monitor's period.
TEST(ControllerSamples, VelocitiesAreObservedWhereADriveSendsNone) {
  Config config = ScriptedJoints::default_config();
  config.monitor.estimator.period_s = 0.002;
  config.velocity_observer.period_s = 0.001;
  config.velocity_observer.bandwidth_rad_s = 100;
  ScriptedJoints arm(config);
  arm.become_passive();
  const std::array<double, 2> speeds{0.01, -0.02};
  for (int i = 0; i < 200; ++i) {
    for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
      arm.drives.joints[j].reading = {static_cast<float>(speeds[j] * 0.002 * i), 77, false};
    }
    arm.tick();
  }
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    EXPECT_NEAR(arm.data->sample.dq[static_cast<Eigen::Index>(j)], speeds[j], 1e-5);
  }
  arm.drives.joints[0].reading = {0, 0.25F, true};
  arm.tick();
  EXPECT_EQ(arm.data->sample.dq[0], 0.25);
}

TEST(ControllerSamples, AreWatchedInPassiveWhereTheConfigurationSaysSo) {
  for (const bool watched : {false, true}) {
    Config config = ScriptedJoints::default_config();
    config.watch_when_passive = watched;
    ScriptedJoints arm(config);
    arm.run(3);
    EXPECT_FALSE(arm.data->monitor.initialised) << "in kInit nothing is";
    arm.become_passive();
    arm.run(4);
    EXPECT_EQ(arm.data->monitor.initialised, watched);
    EXPECT_EQ(arm.data->monitor.tick, watched ? 4U : 0U);
    arm.drives.stop = true;
    arm.tick();
    const std::uint64_t ticks = arm.data->monitor.tick;
    arm.run(3);
    EXPECT_EQ(arm.data->monitor.tick, ticks) << "in kFault nothing is";
  }
}

TEST(ControllerSamples, OfAnEarlierWatchAreForgottenWhereNobodyKnowsWhatWasBetween) {
  Config config = ScriptedJoints::default_config();
  config.watch_when_passive = true;
  ScriptedJoints arm(config);
  arm.become_passive();
  arm.run(10);
  ASSERT_GT(arm.data->monitor.tick, 0U);
  arm.stop(Fault::kOverrun);
  arm.run(10);
  ASSERT_TRUE(arm.clear_fault());
  arm.tick();
  ASSERT_EQ(arm.state(), ControllerState::kPassive);
  EXPECT_EQ(arm.data->monitor.tick, 0U) << "after a fault";

  arm.run(10);
  ASSERT_GT(arm.data->monitor.tick, 0U);
  for (auto& joint : arm.drives.joints) joint.reading.has_velocity = false;
  arm.tick();
  EXPECT_FALSE(arm.data->monitor.initialised) << "a velocity that is not known yet";
  while (!arm.data->monitor.initialised) arm.tick();
  EXPECT_EQ(arm.data->monitor.tick, 0U);
}

// What the arm does is judged from the first sample on that the controller commands itself.
TEST(ControllerSamples, OfAnEarlierWatchAreForgottenAtArming) {
  Config config = ScriptedJoints::default_config();
  config.watch_when_passive = true;
  ScriptedJoints arm(config);
  arm.become_passive();
  arm.run(10);
  ASSERT_TRUE(arm.arm());
  arm.tick();
  EXPECT_EQ(arm.data->monitor.tick, 0U);
  arm.run(10);
  EXPECT_EQ(arm.data->monitor.tick, arm.data->run_ticks);
}

TEST(ControllerSamples, OneThatTheMonitorRefusesIsAFaultWithItsNumber) {
  for (const bool at_once : {true, false}) {
    Config config = ScriptedJoints::default_config();
    config.monitor.chain.joints[1].max_velocity = 1;
    config.arming.speed.fill(2);
    ScriptedJoints arm(config);
    arm.become_passive();
    ASSERT_TRUE(arm.arm());
    if (!at_once) arm.run(10);
    arm.drives.joints[1].reading.velocity = 1.5F;
    arm.tick();
    EXPECT_EQ(arm.fault(), controller::fault_of(Status::kVelocityOutOfRange));
    EXPECT_TRUE(arm.all_commanded(DriveMode::kOff)) << "in the same tick";
  }
}

// As above, for the first sample after some that nobody saw.
TEST(ControllerSamples, OneThatCannotFollowAGapIsAFaultAsWell) {
  Config config = ScriptedJoints::default_config();
  config.monitor.chain.joints[0].max_velocity = 1;
  ScriptedJoints arm(config);
  ASSERT_TRUE(arm.start());
  arm.reads.fill(false);
  arm.tick();
  arm.reads.fill(true);
  arm.drives.joints[0].reading.velocity = 1.5F;
  arm.tick();
  EXPECT_EQ(arm.fault(), controller::fault_of(Status::kVelocityOutOfRange));
}

}  // namespace
}  // namespace offnominal::test
