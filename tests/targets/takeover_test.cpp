// How a controller takes an arm over: its torque comes in, the arm comes to rest, time begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <offnominal/controller/takeover.hpp>

#include "joint_on_desk.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;

// GIVEN a reference at the window's edge WHEN it is armed THEN the torque grows no faster than its
// rate, stays far below its limit, and the joint comes to the reference in the ramp's time.
TEST(Takeover, BringsTheArmToItsReferenceGently) {
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

TEST(Takeover, WhatTheArmAlreadyDoesIsTheBeginningOfTheMotion) {
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
  joint.ticks(3);
  ASSERT_GT(joint.data->run_ticks, 0U);
  EXPECT_NEAR(joint.torque(), 0, 0.2) << "and of the reference from there on";
  joint.ticks(1497);
  const auto wanted = joint.reference_at(1.5);
  EXPECT_NEAR(joint.q, static_cast<double>(wanted.q[0]), 1e-3);
}

// A reference that jumps in the middle of the motion: the torque goes to its limit, by its rate.
TEST(Takeover, TheTorqueRateHoldsEverAfter) {
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
  jumped = false;
  before = joint.torque();
  joint.q = 3;
  for (int i = 0; i < 100; ++i) {
    joint.tick();
    ASSERT_NEAR(joint.torque() - before, -2.0F, 1e-3F) << "down as well, " << i;
    before = joint.torque();
  }
}

// GIVEN a joint that its brake holds against gravity WHEN it is armed and its torque rises as fast
// as it may THEN time and watch wait until the torque is in: nothing is detected meanwhile.
TEST(Takeover, TimeAndWatchWaitUntilTheTorqueIsIn) {
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

JointOnDesk::Config under_gravity(float torque_rate) {
  auto config = JointOnDesk::config();
  config.monitor.chain.gravity_m_s2 = {0, -9.81F, 0};
  config.arming.torque_rate.fill(torque_rate);
  return config;
}

// GIVEN a torque that comes in too slowly WHEN the arm falls meanwhile THEN that is a fault as soon
// as it has left the window of its arming: nothing is watched until the torque is in.
TEST(Takeover, AnArmThatFallsBeforeItsTorqueIsInIsAFault) {
  for (const double weight_nm : {-19.62, 19.62}) {
    JointOnDesk joint(under_gravity(0.01F));
    joint.push_nm = weight_nm;
    ASSERT_EQ(joint.start(), Fault::kNone);
    double furthest = 0;
    int ticks = 0;
    for (; joint.data->state == ControllerState::kArmed && ticks < 3000; ++ticks) {
      furthest = std::max(furthest, std::fabs(joint.q));
      joint.tick();
    }
    EXPECT_EQ(joint.data->fault, Fault::kArmNotHeld);
    EXPECT_LE(furthest, 0.05);
    EXPECT_GT(std::fabs(joint.q), 0.05);
    EXPECT_EQ(joint.data->run_ticks, 0U);
    EXPECT_EQ(joint.mode(), DriveMode::kOff);
    EXPECT_EQ(joint.drive.heartbeat.fault, 172);
  }
}

// GIVEN a brake that stays closed WHEN the torque would take half a minute THEN it is given up
// after ten seconds.
TEST(Takeover, ATorqueThatDoesNotComeInHasAnEnd) {
  JointOnDesk joint(under_gravity(0.5F));
  joint.brake_at = 0;
  ASSERT_EQ(joint.start(), Fault::kNone);
  // And 20 ms for the drives to follow, and the age of what they say.
  joint.ticks(10'000 + 22);
  ASSERT_EQ(joint.data->state, ControllerState::kArmed);
  ASSERT_EQ(joint.data->run_ticks, 0U);
  joint.ticks(3);
  EXPECT_EQ(joint.data->fault, Fault::kArmNotHeld);
}

// An arm that sinks while its weight is taken over is brought to rest before time begins; one that
// is shaken on and on has twice the way of the torque, 0.1 s, and the ramp's time.
TEST(Takeover, TimeBeginsWithAnArmAtRest) {
  JointOnDesk sinking(under_gravity(500));
  sinking.push_nm = -19.62;
  ASSERT_EQ(sinking.start(), Fault::kNone);
  double fastest = 0;
  int ticks = 0;
  for (; sinking.data->run_ticks == 0 && ticks < 1000; ++ticks) {
    sinking.tick();
    ASSERT_EQ(sinking.data->state, ControllerState::kArmed);
    fastest = std::max(fastest, std::fabs(sinking.dq));
  }
  EXPECT_GT(fastest, 0.1);
  EXPECT_LT(std::fabs(static_cast<double>(sinking.data->sample.dq[0])), 0.05);
  EXPECT_GT(ticks, 40) << "the torque is in";
  const double begin = sinking.q;
  EXPECT_LT(begin, -0.003);
  EXPECT_NEAR(static_cast<double>(sinking.data->ramp.q[0]), -begin, 1e-3) << "from there on";
  sinking.ticks(1500);
  EXPECT_NEAR(sinking.q, 0, 1e-3) << "where it was armed";
  EXPECT_FALSE(sinking.data->output.detector.latched);

  auto config = JointOnDesk::config();
  config.arming.torque_rate.fill(1000);
  JointOnDesk shaken(config);
  ASSERT_EQ(shaken.start(), Fault::kNone);
  const auto shake = [&](int count) {
    for (int i = 0; i < count; ++i) {
      shaken.q = 0;
      shaken.dq = 0.06;
      shaken.tick();
    }
  };
  shaken.tick();
  shake(1200);
  ASSERT_EQ(shaken.data->state, ControllerState::kArmed);
  ASSERT_EQ(shaken.data->run_ticks, 0U);
  shake(30);
  EXPECT_EQ(shaken.data->fault, Fault::kArmNotHeld);
}

// GIVEN a sample that is missing as the torque comes in WHEN the next one comes THEN time does not
// begin with it, but with the one after: what lies before the first sample was not watched.
TEST(Takeover, TimeBeginsWithASampleRightAfterAnother) {
  int whole = 0;
  for (const bool misses : {false, true}) {
    JointOnDesk joint;
    ASSERT_EQ(joint.start(), Fault::kNone);
    if (misses) {
      joint.ticks(whole - 1);
      ASSERT_EQ(joint.data->run_ticks, 0U);
      joint.encoder_speaks = false;
      joint.tick();
      EXPECT_FALSE(joint.data->drives_follow) << "without a sample";
      joint.encoder_speaks = true;
      joint.tick();
      EXPECT_FALSE(joint.data->drives_follow) << "after one that is missing";
      joint.tick();
      EXPECT_TRUE(joint.data->drives_follow);
    }
    for (; !misses && joint.data->run_ticks == 0 && whole < 100; ++whole) joint.tick();
  }
  ASSERT_GT(whole, 1);
}

// GIVEN a drive that gives torque and says so late WHEN the reference begins with an acceleration
// THEN the arm stays where it is until time begins.
TEST(Takeover, HoldsTheArmUntilTheDriveSaysThatItFollows) {
  auto config = JointOnDesk::config();
  config.time_to_follow_us = 300'000;
  JointOnDesk joint(config);
  joint.reference_at = [](double time_s) {
    return at(static_cast<float>(0.3 * (1 - std::cos(3 * time_s))),
              static_cast<float>(0.9 * std::sin(3 * time_s)),
              static_cast<float>(2.7 * std::cos(3 * time_s)));
  };
  joint.tells_mode = false;
  ASSERT_EQ(joint.start(), Fault::kNone);
  for (int i = 0; i < 250; ++i) {
    joint.tick();
    ASSERT_EQ(joint.data->state, ControllerState::kArmed);
    ASSERT_EQ(joint.torque(), 0.0F) << i;
  }
  EXPECT_EQ(joint.q, 0.0);
  joint.tells_mode = true;
  joint.ticks(1000);
  EXPECT_EQ(joint.data->run_ticks, 1000U);
  EXPECT_NEAR(joint.q, 0.3 * (1 - std::cos(3.0)), 1e-2);
}

// What it moves when it is armed fades out meanwhile; it is not stopped with a jerk.
TEST(Takeover, AMovingArmComesToRestUntilTheDriveSaysThatItFollows) {
  auto config = JointOnDesk::config();
  config.time_to_follow_us = 3'000'000;
  config.arming.speed.fill(0.2F);
  JointOnDesk joint(config);
  joint.dq = 0.15;
  joint.tells_mode = false;
  ASSERT_EQ(joint.start(), Fault::kNone);
  const double begin = joint.q;
  for (int i = 0; i < 1500; ++i) {
    joint.tick();
    ASSERT_EQ(joint.data->state, ControllerState::kArmed) << name_of(joint.data->fault);
    ASSERT_LT(std::fabs(joint.torque()), 2.5F) << "0.15 rad/s in 1 s; at once it would be 6";
  }
  EXPECT_NEAR(joint.q, begin, 1e-3);
  EXPECT_NEAR(joint.dq, 0, 1e-3);
}

// The window is about where it was armed, wherever that is.
TEST(Takeover, HoldsAnArmFarFromZeroAsWell) {
  for (const double place : {-1.5, 1.5}) {
    JointOnDesk joint;
    joint.q = place;
    joint.reference_at = [place](double) { return at(static_cast<float>(place)); };
    ASSERT_EQ(joint.start(), Fault::kNone);
    joint.ticks(100);
    EXPECT_EQ(joint.data->state, ControllerState::kArmed) << name_of(joint.data->fault);
    EXPECT_GT(joint.data->run_ticks, 90U);
    EXPECT_NEAR(joint.q, place, 1e-4);
  }
}

// GIVEN a moving arm WHEN its first sample after arming comes late THEN it begins to come to rest
// at that sample, and not where it would be by now.
TEST(Takeover, AMovingArmBeginsToComeToRestAtItsFirstSample) {
  auto config = JointOnDesk::config();
  config.arming.speed.fill(0.2F);
  JointOnDesk joint(config);
  joint.dq = 0.15;
  joint.tells_mode = false;
  joint.ticks(2);
  ASSERT_EQ(joint.arm(), Fault::kNone);
  joint.tick(3);
  ASSERT_EQ(joint.data->state, ControllerState::kArmed);
  EXPECT_NEAR(joint.torque(), 0, 1e-3);
  EXPECT_EQ(joint.mode(), DriveMode::kTorque);
}

}  // namespace
}  // namespace offnominal::test
