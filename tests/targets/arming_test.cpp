// What a controller asks for before it commands torque, and how it begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "joint_on_desk.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;

Reference<1, float> at(float q, float dq = 0, float ddq = 0) {
  Reference<1, float> reference;
  reference.q[0] = q;
  reference.dq[0] = dq;
  reference.ddq[0] = ddq;
  return reference;
}

// Neither the state nor a command has changed, and the next ticks go on so.
void expect_untouched(JointOnDesk& joint) {
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
  joint.ticks(3);
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
  EXPECT_EQ(joint.data->fault, Fault::kNone);
  EXPECT_EQ(joint.mode(), DriveMode::kOff);
}

TEST(Arming, TakesPassiveAndAFreshSample) {
  JointOnDesk joint;
  EXPECT_EQ(joint.arm(), Fault::kNotPassive);
  joint.ticks(2);
  ASSERT_EQ(joint.data->state, ControllerState::kPassive);
  joint.encoder_speaks = false;
  joint.tick();
  EXPECT_EQ(joint.arm(), Fault::kNoFreshSample);
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
  joint.encoder_speaks = true;
  joint.tick();
  EXPECT_EQ(joint.arm(), Fault::kNone);
  EXPECT_EQ(joint.arm(), Fault::kNotPassive) << "armed twice";
}

TEST(Arming, RefusesAReferenceFarFromTheArm) {
  JointOnDesk joint;
  joint.reference_at = [](double) { return at(2.5F); };
  joint.ticks(2);
  EXPECT_EQ(joint.arm(), Fault::kReferenceFarFromArm);
  expect_untouched(joint);
  joint.reference_at = [](double) { return at(-0.0501F); };
  EXPECT_EQ(joint.arm(), Fault::kReferenceFarFromArm) << "either way";
  joint.reference_at = [](double) { return at(-0.0499F); };
  EXPECT_EQ(joint.arm(), Fault::kNone);
}

TEST(Arming, RefusesAnArmThatMoves) {
  JointOnDesk joint;
  joint.ticks(2);
  for (const double speed : {0.051, -0.051}) {
    joint.dq = speed;
    joint.tick();
    EXPECT_EQ(joint.arm(), Fault::kArmMoving) << speed;
  }
  joint.dq = 0.049;
  joint.tick();
  EXPECT_EQ(joint.arm(), Fault::kNone);
}

TEST(Arming, RefusesAReferenceThatMovesUnlessItIsAllowedTo) {
  JointOnDesk resting;
  resting.reference_at = [](double time_s) { return at(static_cast<float>(0.3 * time_s), 0.3F); };
  resting.ticks(2);
  EXPECT_EQ(resting.arm(), Fault::kReferenceMoving);
  expect_untouched(resting);
  auto config = JointOnDesk::config();
  config.arming.speed.fill(0.35F);
  JointOnDesk moving(config);
  moving.reference_at = resting.reference_at;
  moving.dq = 0.3;
  moving.ticks(2);
  EXPECT_EQ(moving.arm(), Fault::kNone);
}

TEST(Arming, RefusesGainsOfZero) {
  for (const bool proportional : {true, false}) {
    auto config = JointOnDesk::config();
    (proportional ? config.gains.kp : config.gains.kd).fill(0);
    JointOnDesk joint(config);
    joint.ticks(2);
    EXPECT_EQ(joint.arm(), Fault::kNoGains);
    expect_untouched(joint);
  }
}

TEST(Arming, RefusesATorqueWithoutALimit) {
  auto config = JointOnDesk::config();
  config.monitor.chain.joints[0].max_torque = std::numeric_limits<float>::max();
  JointOnDesk joint(config);
  joint.ticks(2);
  EXPECT_EQ(joint.arm(), Fault::kNoTorqueLimit);
  expect_untouched(joint);
}

TEST(Arming, RefusesAReferenceThatIsNone) {
  JointOnDesk joint;
  joint.ticks(2);
  joint.reference_at = [](double) { return at(std::numeric_limits<float>::quiet_NaN()); };
  EXPECT_EQ(joint.arm(), controller::fault_of(Status::kNonFiniteReference));
  joint.reference_at = [](double) { return at(1e30F); };
  EXPECT_EQ(joint.arm(), Fault::kReferenceOutOfRange);
  expect_untouched(joint);
}

// GIVEN arm() has said yes WHEN the arm is pushed away before the next sample THEN that is a fault,
// and no torque is commanded.
TEST(Arming, JudgesAgainAtTheFirstSample) {
  JointOnDesk joint;
  joint.ticks(2);
  ASSERT_EQ(joint.arm(), Fault::kNone);
  joint.q = 1;
  joint.tick();
  EXPECT_EQ(joint.data->state, ControllerState::kFault);
  EXPECT_EQ(joint.data->fault, Fault::kReferenceFarFromArm);
  EXPECT_EQ(joint.mode(), DriveMode::kOff);
  EXPECT_EQ(joint.drive.heartbeat.fault, 185);
}

// GIVEN a reference at the window's edge WHEN it is armed THEN the torque grows no faster than its
// rate, stays far below its limit, and the joint comes to the reference in the ramp's time.
TEST(Arming, BringsTheArmToItsReferenceGently) {
  JointOnDesk joint;
  joint.reference_at = [](double) { return at(0.049F); };
  ASSERT_EQ(joint.start(), Fault::kNone);
  float largest = 0;
  double fastest = 0;
  for (int i = 0; i < 1500; ++i) {
    const float before = joint.torque();
    joint.tick();
    ASSERT_EQ(joint.data->state, ControllerState::kArmed) << i;
    ASSERT_LE(std::fabs(joint.torque() - before), 2.0F + 1e-4F) << "100 N m in 50 ms, tick " << i;
    largest = std::max(largest, std::fabs(joint.torque()));
    fastest = std::max(fastest, std::fabs(joint.dq));
  }
  EXPECT_NEAR(joint.q, 0.049, 1e-4);
  // 5.8 and 1.9 times the difference over the ramp's time (squared), and what tracking adds.
  EXPECT_LT(largest, 1.0F) << "without a ramp 9.8 N m";
  EXPECT_GT(largest, 0.3F);
  EXPECT_LT(fastest, 0.11);
}

TEST(Arming, WhatTheArmAlreadyDoesIsTheBeginningOfTheMotion) {
  auto config = JointOnDesk::config();
  config.arming.speed.fill(0.5F);
  JointOnDesk joint(config);
  joint.dq = 0.2;
  joint.q = -0.002;
  joint.reference_at = [](double time_s) {
    return at(static_cast<float>(0.02 + 0.4 * time_s), 0.4F);
  };
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.tick();
  EXPECT_NEAR(joint.torque(), 0, 0.01) << "position, velocity and acceleration are the arm's own";
  joint.ticks(1500);
  const auto wanted = joint.reference_at(1.5);
  EXPECT_NEAR(joint.q, static_cast<double>(wanted.q[0]), 1e-3);
}

// A reference that jumps in the middle of the motion: the torque goes to its limit, by its rate.
TEST(Arming, TheTorqueRateHoldsEverAfter) {
  JointOnDesk joint;
  bool jumped = false;
  joint.reference_at = [&](double) { return at(jumped ? 3.0F : 0.0F); };
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(100);
  jumped = true;
  float before = joint.torque();
  for (int i = 0; i < 50; ++i) {
    joint.tick();
    ASSERT_NEAR(joint.torque() - before, 2.0F, 1e-3F) << i;
    before = joint.torque();
  }
  joint.tick();
  EXPECT_EQ(joint.torque(), 100.0F) << "its limit";
}

// GIVEN a joint that its brake holds against gravity WHEN it is armed and its torque rises as fast
// as it may THEN time and watch wait until the torque is in: nothing is detected meanwhile.
TEST(Arming, TimeAndWatchWaitUntilTheTorqueIsIn) {
  JointOnDesk::Config config = JointOnDesk::config();
  config.monitor.chain.gravity_m_s2 = {0, -9.81F, 0};
  JointOnDesk joint(config);
  ASSERT_EQ(joint.start(), Fault::kNone);
  const float weight_nm = 9.81F * static_cast<float>(JointOnDesk::kInertia);
  int ticks = 0;
  for (; joint.torque() < weight_nm - 1 && ticks < 100; ++ticks) {
    joint.tick();
    joint.q = joint.dq = 0;
    ASSERT_EQ(joint.data->run_ticks, 0U);
  }
  EXPECT_EQ(ticks, 10) << "2 N m in a tick";
  for (int i = 0; i < 200; ++i) {
    joint.tick();
    joint.q = joint.dq = 0;
    ASSERT_FALSE(joint.data->output.detector.level) << i;
  }
  EXPECT_EQ(joint.data->run_ticks, 200U);
  EXPECT_EQ(joint.data->state, hal::ControllerState::kArmed);
}

TEST(Arming, AConfigurationThatDoesNotSayHowIsRefused) {
  JointOnDesk::Controller controller;
  const auto refused = [&](auto&& change) {
    auto config = JointOnDesk::config();
    change(config);
    return JointOnDesk::Controller::create(config, controller) == Status::kInvalidLimit;
  };
  using Config = JointOnDesk::Config;
  EXPECT_TRUE(refused([](Config& config) { config.arming = {}; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.position_window[0] = 0; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.speed[0] = -1; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.torque_rate[0] = INFINITY; }));
  EXPECT_TRUE(refused([](Config& config) { config.arming.ramp_s = NAN; }));
  EXPECT_TRUE(refused([](Config& config) { config.most_position = 0; }));
  EXPECT_FALSE(refused([](Config&) {}));
}

// A number that is none, or that no joint can follow, never becomes a command.
TEST(ArmedController, AReferenceThatIsNoneIsAFaultBeforeAnyCommand) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const auto non_finite = controller::fault_of(Status::kNonFiniteReference);
  struct Case {
    Reference<1, float> reference;
    Fault fault;
  };
  for (const Case& wrong :
       {Case{at(kNan), non_finite}, Case{at(0, kNan), non_finite}, Case{at(0, 0, kNan), non_finite},
        Case{at(-kInf), non_finite}, Case{at(0, kInf), non_finite},
        Case{at(1e30F), Fault::kReferenceOutOfRange}, Case{at(3.1F), Fault::kReferenceOutOfRange},
        Case{at(-3.1F), Fault::kReferenceOutOfRange},
        Case{at(0, 5.1F), Fault::kReferenceOutOfRange},
        Case{at(0, -5.1F), Fault::kReferenceOutOfRange},
        Case{at(0, 0, 3e38F), controller::fault_of(Status::kNumericOverflow)}}) {
    auto config = JointOnDesk::config();
    config.monitor.chain.joints[0].min_position = -3;
    config.monitor.chain.joints[0].max_position = 3;
    config.monitor.chain.joints[0].max_velocity = 5;
    config.safe_mode = DriveMode::kDamping;
    JointOnDesk joint(config);
    ASSERT_EQ(joint.start(), Fault::kNone);
    joint.ticks(100);
    ASSERT_EQ(joint.mode(), DriveMode::kTorque);
    joint.reference_at = [&](double) { return wrong.reference; };
    joint.tick();
    EXPECT_EQ(joint.data->fault, wrong.fault) << name_of(wrong.fault);
    EXPECT_EQ(joint.mode(), DriveMode::kDamping);
    EXPECT_EQ(joint.torque(), 0.0F);
    EXPECT_EQ(joint.drive.heartbeat.fault, static_cast<std::uint8_t>(wrong.fault));
    EXPECT_GE(joint.bus.dropped, 1);
  }
}

TEST(ArmedController, WithoutLimitsAReferenceStillHasToBePlausible) {
  JointOnDesk joint;
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(10);
  joint.reference_at = [](double) { return at(1001); };
  joint.tick();
  EXPECT_EQ(joint.data->fault, Fault::kReferenceOutOfRange);
}

}  // namespace
}  // namespace offnominal::test
