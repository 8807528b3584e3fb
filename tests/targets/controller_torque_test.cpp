// The torque that the joint controller commands.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <offnominal/controller/takeover.hpp>
#include <offnominal/controller/torque_limiter.hpp>
#include <vector>

#include "scripted_joints.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;
using Config = ScriptedJoints::Controller::Config;

TEST(ControllerTorque, IsTheComputedTorqueOfEveryJoint) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  Reference<2, double> reference;
  reference.q = {0.002, -0.003};
  reference.dq = {0.01, 0.02};
  reference.ddq = {0.1, -0.2};
  arm.reference_at = [&reference](double) { return reference; };
  arm.drives.joints[0].reading = {0.001F, -0.01F, true};
  arm.drives.joints[1].reading = {-0.001F, 0.03F, true};
  arm.tick();
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    const auto& reading = arm.drives.joints[j].reading;
    const double wanted =
        ScriptedJoints::kMass[j] *
        (reference.ddq[i] +
         ScriptedJoints::kKd * (reference.dq[i] - static_cast<double>(reading.velocity)) +
         ScriptedJoints::kKp * (reference.q[i] - static_cast<double>(reading.position)));
    EXPECT_EQ(arm.drives.commands[j].mode, DriveMode::kTorque);
    EXPECT_NEAR(static_cast<double>(arm.drives.commands[j].torque), wanted, 1e-5);
  }
}

// In both directions, at every joint, whatever the others want.
TEST(ControllerTorque, IsHeldToWhatTheDriveCanGive) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    for (const double sign : {-1.0, 1.0}) {
      ScriptedJoints arm;
      ASSERT_TRUE(arm.start());
      const auto i = static_cast<Eigen::Index>(j);
      Reference<2, double> reference;
      arm.reference_at = [&reference](double) { return reference; };
      const auto commanded = [&arm, &reference, i, j, sign](double wanted) {
        reference.q[i] = sign * wanted / (ScriptedJoints::kMass[j] * ScriptedJoints::kKp);
        arm.tick();
        return static_cast<double>(arm.drives.commands[j].torque);
      };
      EXPECT_NEAR(commanded(9.9), sign * 9.9, 1e-5);
      EXPECT_EQ(commanded(10.1), sign * ScriptedJoints::kMaxTorque);
      EXPECT_EQ(commanded(1000), sign * ScriptedJoints::kMaxTorque);
      EXPECT_EQ(arm.drives.commands[1 - j].torque, 0.0F);
      EXPECT_EQ(arm.state(), ControllerState::kArmed);
    }
  }
}

// GIVEN a limit that no float is WHEN the torque is at it THEN no command is above it, and a drive
// that gives what it is told, or a little more, is healthy; one that gives far more is not.
TEST(ControllerTorque, AtItsLimitIsNoFault) {
  for (const double limit : {0.1, 0.7, 3.3, 10.0}) {
    for (const double sign : {-1.0, 1.0}) {
      Config config = ScriptedJoints::default_config();
      for (auto& joint : config.monitor.chain.joints) joint.max_torque = limit;
      ScriptedJoints arm(config);
      ASSERT_TRUE(arm.start());
      Reference<2, double> far;
      far.q.fill(sign);
      arm.reference_at = [&far](double) { return far; };
      arm.run(50);
      ASSERT_EQ(arm.state(), ControllerState::kArmed) << limit << ' ' << name_of(arm.fault());
      const auto commanded = static_cast<double>(arm.drives.commands[0].torque);
      EXPECT_LE(sign * commanded, limit);
      EXPECT_NEAR(sign * commanded, limit, 1e-6 * limit);
      arm.follows.fill(false);
      for (const double share : {0.97, 1.03, 1.19}) {
        arm.drives.joints[0].status.applied_torque = static_cast<float>(share * sign * limit);
        arm.run(5);
        EXPECT_EQ(arm.state(), ControllerState::kArmed) << share;
      }
      arm.drives.joints[0].status.applied_torque = static_cast<float>(1.3 * sign * limit);
      arm.tick();
      EXPECT_EQ(arm.fault(), controller::fault_of(Status::kTorqueOutOfRange));
    }
  }
}

TEST(ControllerTorque, TheLargestCommandIsNoneAboveItsLimit) {
  for (const double limit : {1e-30, 0.1, 0.3, 1.0, 100.1, 1e10 / 3}) {
    const float command = controller::largest_command(limit);
    EXPECT_LE(static_cast<double>(command), limit);
    EXPECT_GT(static_cast<double>(std::nextafter(command, INFINITY)), limit);
  }
  EXPECT_EQ(controller::largest_command(0.1F), 0.1F);
  constexpr float kMost = std::numeric_limits<float>::max();
  EXPECT_EQ(controller::largest_command(1e300), kMost);
  EXPECT_EQ(controller::largest_command(std::numeric_limits<double>::infinity()), kMost);
  EXPECT_EQ(controller::largest_command(std::numeric_limits<float>::infinity()), kMost);
}

TEST(ControllerTorque, FollowsAReferenceThatIsAskedOncePerTickAtItsTime) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  std::vector<double> asked;
  arm.reference_at = [&asked](double time_s) {
    asked.push_back(time_s);
    return Reference<2, double>{};
  };
  const double before_s = 0.001 * static_cast<double>(arm.data->run_ticks);
  arm.tick();
  arm.tick(3);
  arm.tick();
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_NEAR(asked[0], before_s + 0.001, 1e-12);
  EXPECT_NEAR(asked[1], before_s + 0.005, 1e-12);
  EXPECT_NEAR(asked[2], before_s + 0.006, 1e-12);
}

// Until every drive follows, the reference stands at its beginning.
TEST(ControllerTorque, IsHeldWhereASampleIsMissing) {
  ScriptedJoints arm;
  ASSERT_TRUE(arm.start());
  arm.reference_at = [](double time_s) {
    Reference<2, double> reference;
    reference.q.fill(0.01 * time_s);
    return reference;
  };
  arm.run(100);
  const auto before = arm.drives.commands;
  arm.reads[1] = false;
  arm.tick();
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    EXPECT_EQ(arm.drives.commands[j].torque, before[j].torque);
    EXPECT_EQ(arm.drives.commands[j].mode, DriveMode::kTorque);
  }
  arm.reads[1] = true;
  arm.tick();
  EXPECT_NE(arm.drives.commands[0].torque, before[0].torque);
}

TEST(ControllerTorque, TimeStandsUntilEveryDriveFollows) {
  ScriptedJoints arm;
  arm.become_passive();
  arm.follows[1] = false;
  ASSERT_TRUE(arm.arm());
  double last_s = -1;
  arm.reference_at = [&last_s](double time_s) {
    last_s = time_s;
    return Reference<2, double>{};
  };
  for (int i = 0; i < 10; ++i) {
    arm.tick();
    ASSERT_EQ(last_s, 0.0);
    ASSERT_TRUE(arm.all_commanded(DriveMode::kTorque));
    ASSERT_EQ(arm.data->monitor.tick, 0U);
    ASSERT_FALSE(arm.data->drives_follow);
  }
  arm.follows[1] = true;
  arm.run(5);
  EXPECT_TRUE(arm.data->drives_follow);
  EXPECT_EQ(arm.data->waiting_ticks, 10U);
  EXPECT_EQ(arm.data->run_ticks, 5U);
  EXPECT_NEAR(last_s, 0.005, 1e-12);
}

// One joint's torque takes longer than the other's to come in.
TEST(ControllerTorque, TimeStandsUntilTheTorqueOfEveryJointIsIn) {
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    Config config = ScriptedJoints::default_config();
    config.monitor.chain.gravity_m_s2 = {-0.3, -0.5, 0};  // 1.5 N at both
    config.arming.torque_rate[j] = 100;                   // 0.1 N in a tick
    ScriptedJoints arm(config);
    arm.become_passive();
    ASSERT_TRUE(arm.arm());
    for (int i = 1; i <= 15; ++i) {
      arm.tick();
      ASSERT_EQ(arm.state(), ControllerState::kArmed);
      ASSERT_FALSE(arm.data->drives_follow) << i;
      ASSERT_NEAR(static_cast<double>(arm.drives.commands[j].torque), 0.1 * i, 1e-5);
      ASSERT_NEAR(static_cast<double>(arm.drives.commands[1 - j].torque), 1.5, 1e-5);
    }
    arm.run(3);
    EXPECT_TRUE(arm.data->drives_follow);
  }
}

// The monitor begins with the torque that the drives give from the first sample on.
TEST(ControllerTorque, TheFirstOneIsInTheFirstSampleThatIsWatched) {
  Config config = ScriptedJoints::default_config();
  config.monitor.chain.gravity_m_s2 = {0.1, -0.2, 0};
  ScriptedJoints arm(config);
  arm.become_passive();
  ASSERT_TRUE(arm.arm());
  arm.tick();
  ASSERT_TRUE(arm.data->monitor.initialised);
  for (std::size_t j = 0; j < ScriptedJoints::kJoints; ++j) {
    EXPECT_NE(arm.drives.commands[j].torque, 0.0F);
    EXPECT_NEAR(arm.data->monitor.sample.tau[static_cast<Eigen::Index>(j)],
                static_cast<double>(arm.drives.commands[j].torque), 1e-6);
  }
}

}  // namespace
}  // namespace offnominal::test
