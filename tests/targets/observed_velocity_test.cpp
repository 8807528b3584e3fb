// Positions that cannot be, and velocities that nobody sends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/controller/sample_taker.hpp>

#include "joint_on_desk.hpp"

namespace offnominal::test {
namespace {

using controller::Fault;
using hal::ControllerState;
using hal::DriveMode;

JointOnDesk::Config observing() {
  auto config = JointOnDesk::config();
  config.monitor.bound.velocity_error = velocity_error_bound(config.velocity_observer, 5.0F, 2e-6F);
  return config;
}

// GIVEN a joint that moves at 2 rad/s WHEN its encoder is silent for 10 s and the fault is then
// cleared THEN it is not armed before its velocity is known, and it is held without a jerk.
TEST(ObservedVelocity, IsForgottenWhereTheEncoderWasSilent) {
  JointOnDesk joint(observing());
  joint.sends_velocity = false;
  joint.dq = 2;
  joint.ticks(200);
  EXPECT_NEAR(joint.data->sample.dq[0], 2, 1e-3);
  joint.encoder_speaks = false;
  joint.ticks(10'000);
  ASSERT_EQ(joint.data->fault, Fault::kEncoderSilent);
  joint.encoder_speaks = true;
  joint.dq = 0;
  joint.q = 0;
  ASSERT_TRUE(joint.clear_fault());
  int ticks = 0;
  for (Fault refusal = Fault::kNotPassive; refusal != Fault::kNone; ++ticks) {
    joint.tick();
    refusal = joint.arm();
    ASSERT_TRUE(refusal == Fault::kNone || passes_by_itself(refusal)) << name_of(refusal);
    ASSERT_LT(ticks, 60);
  }
  EXPECT_GT(ticks, 30) << "armed before the velocity was known";
  float largest = 0;
  for (int i = 0; i < 200; ++i) {
    joint.tick();
    ASSERT_LT(std::fabs(joint.data->sample.dq[0]), 0.01F) << i;
    largest = std::max(largest, std::fabs(joint.torque()));
  }
  EXPECT_EQ(joint.data->state, ControllerState::kArmed);
  EXPECT_LT(largest, 0.1F);
  EXPECT_FALSE(joint.data->output.detector.latched);
}

TEST(ObservedVelocity, IsNotUsedForArmingBeforeItHasSettled) {
  JointOnDesk joint(observing());
  joint.sends_velocity = false;
  joint.dq = 1;
  joint.ticks(5);
  ASSERT_EQ(joint.data->state, ControllerState::kPassive);
  EXPECT_EQ(joint.arm(), Fault::kVelocityUnsettled);
  joint.ticks(100);
  joint.q = 0;
  EXPECT_EQ(joint.arm(), Fault::kReferenceFarFromArm);
  joint.reference_at = [&](double) {
    Reference<1, float> reference;
    reference.q[0] = joint.data->sample.q[0];
    return reference;
  };
  EXPECT_EQ(joint.arm(), Fault::kArmMoving);
}

// One late tick is borne, one that is later than the observer can bridge is a fault.
TEST(ObservedVelocity, IsNotUsedForControlAfterALongGap) {
  auto config = observing();
  config.late_ticks_allowed = 20;
  JointOnDesk joint(config);
  joint.sends_velocity = false;
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(50);
  joint.tick(3);
  joint.ticks(5);
  EXPECT_EQ(joint.data->state, ControllerState::kArmed);
  joint.tick(20);
  EXPECT_EQ(joint.data->fault, Fault::kVelocityUnknown);
  EXPECT_EQ(joint.mode(), DriveMode::kOff);
}

TEST(ObservedVelocity, IsNotWatchedBeforeItHasSettled) {
  auto config = observing();
  config.watch_when_passive = true;
  JointOnDesk joint(config);
  joint.sends_velocity = false;
  joint.dq = 3;
  joint.ticks(10);
  EXPECT_FALSE(joint.data->monitor.initialised);
  joint.ticks(500);
  EXPECT_TRUE(joint.data->monitor.initialised);
  EXPECT_FALSE(joint.data->output.detector.latched);
}

// GIVEN an arm that brakes or hands held before its drives did WHEN time begins THEN nothing is
// judged until what is observed is of the time since then, and the run's time goes on meanwhile.
TEST(ObservedVelocity, IsNotJudgedOfTheTimeBeforeTheDrivesFollowed) {
  JointOnDesk joint(observing());
  joint.sends_velocity = false;
  ASSERT_EQ(joint.start(), Fault::kNone);
  while (!joint.data->drives_follow) joint.tick();
  const std::uint64_t begin = joint.data->monitor.tick - joint.data->run_ticks;
  joint.push_nm = 3;
  int ticks = 0;
  for (; joint.controller.is_settling(*joint.data); joint.tick()) {
    ASSERT_EQ(joint.data->output.error_norm, 0) << ticks;
    ASSERT_LT(++ticks, 60);
  }
  EXPECT_GT(ticks, 40);
  EXPECT_EQ(joint.data->monitor.tick - joint.data->run_ticks, begin);
  joint.ticks(5);
  EXPECT_EQ(joint.data->monitor.tick - joint.data->run_ticks, begin);
  EXPECT_GT(joint.data->output.error_norm, 0);
}

// GIVEN an encoder that once says what cannot be WHEN that passes THEN nothing of it is used; a
// third one in a row is a fault with its number.
TEST(ImplausiblePosition, EntersNeitherSampleNorVelocity) {
  for (const bool sent : {true, false}) {
    for (const float wrong : {1e30F, -1e30F, 1001.0F, std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity()}) {
      JointOnDesk joint(observing());
      joint.sends_velocity = sent;
      ASSERT_EQ(joint.start(), Fault::kNone);
      joint.ticks(100);
      joint.lie = wrong;
      joint.ticks(2);
      ASSERT_EQ(joint.data->state, ControllerState::kArmed);
      EXPECT_EQ(joint.data->missed_samples, 2U);
      EXPECT_NEAR(joint.data->sample.q[0], 0, 1e-3);
      joint.lie.reset();
      joint.ticks(20);
      EXPECT_EQ(joint.data->state, ControllerState::kArmed);
      EXPECT_NEAR(joint.data->sample.dq[0], 0, 1e-3);

      joint.lie = wrong;
      joint.ticks(3);
      EXPECT_EQ(joint.data->fault,
                controller::fault_of(std::isfinite(wrong) ? Status::kPositionOutOfRange
                                                          : Status::kNonFinitePosition));
      EXPECT_EQ(joint.mode(), DriveMode::kOff);
      ASSERT_TRUE(joint.clear_fault());
      joint.ticks(100);
      EXPECT_EQ(joint.data->state, ControllerState::kInit) << "as long as it lasts";
      joint.lie.reset();
      ASSERT_EQ(joint.start(), Fault::kNone);
      joint.ticks(100);
      EXPECT_EQ(joint.data->state, ControllerState::kArmed);
      EXPECT_NEAR(joint.data->sample.dq[0], 0, 1e-3);
    }
  }
}

// GIVEN an encoder that speaks every tenth tick WHEN two of its readings in a row cannot be THEN
// that is borne, as two ticks of a faster one are; the third is a fault.
TEST(ImplausiblePosition, IsCountedByReadingsAndNotByTicks) {
  JointOnDesk joint;
  joint.max_silence_us = 25'000;
  ASSERT_EQ(joint.start(), Fault::kNone);
  joint.ticks(50);
  const auto speak = [&](std::optional<float> lie) {
    joint.lie = lie;
    joint.encoder_speaks = true;
    joint.tick();
    joint.encoder_speaks = false;
    joint.ticks(9);
  };
  for (int round = 0; round < 2; ++round) {
    speak(1e6F);
    speak(1e6F);
    ASSERT_EQ(joint.data->state, ControllerState::kArmed);
    EXPECT_EQ(joint.data->implausible_in_a_row, 2);
    speak({});
    ASSERT_EQ(joint.data->state, ControllerState::kArmed);
    EXPECT_EQ(joint.data->implausible_in_a_row, 0);
  }
  speak(1e6F);
  speak(1e6F);
  speak(1e6F);
  EXPECT_EQ(joint.data->fault, controller::fault_of(Status::kPositionOutOfRange));
}

TEST(ImplausiblePosition, IsOneBeyondTheJointsLimitsWhereItHasThem) {
  auto config = JointOnDesk::config();
  config.monitor.chain.joints[0].min_position = -1;
  config.monitor.chain.joints[0].max_position = 2;
  JointOnDesk joint(config);
  for (const double wrong : {-1.001, 2.001}) {
    joint.q = wrong;
    joint.ticks(5);
    EXPECT_EQ(joint.data->state, ControllerState::kInit) << wrong;
  }
  joint.q = 1.999;
  joint.ticks(5);
  EXPECT_EQ(joint.data->state, ControllerState::kPassive);
}

// GIVEN a joint without limits that turns on and on WHEN its frames come to the end of what they
// carry THEN nothing jumps, either way, and it is driven past it.
TEST(TurningJoint, IsFollowedBeyondWhatAFrameCarries) {
  for (const bool sent : {true, false}) {
    for (const double speed : {2.0, -2.0}) {
      auto config = observing();
      config.arming.speed.fill(2.5F);
      JointOnDesk joint(config);
      joint.sends_velocity = sent;
      joint.q = 15 * speed;
      joint.dq = speed;
      joint.reading_of = hal::carried_position;
      double begin = 0;
      joint.reference_at = [&](double time_s) {
        if (time_s == 0) begin = static_cast<double>(joint.data->sample.q[0]);
        Reference<1, float> reference;
        reference.q[0] = static_cast<float>(begin + speed * time_s);
        reference.dq[0] = static_cast<float>(speed);
        return reference;
      };
      ASSERT_EQ(joint.start(), Fault::kNone);
      for (int i = 0; i < 60'000; ++i) {
        const float before = joint.data->sample.q[0];
        joint.tick();
        ASSERT_EQ(joint.data->state, ControllerState::kArmed) << name_of(joint.data->fault);
        ASSERT_LT(std::fabs(joint.data->sample.q[0] - before), 0.01F) << "at " << joint.q;
      }
      EXPECT_GT(std::fabs(joint.q), 140) << "past two ends";
      EXPECT_NEAR(joint.data->sample.q[0], joint.q, 1e-3);
      EXPECT_FALSE(joint.data->output.detector.latched);
    }
  }
}

TEST(TurningJoint, CountsFromWhatIsCarriedAfterAFault) {
  JointOnDesk joint;
  joint.reading_of = hal::carried_position;
  joint.q = 31;
  joint.ticks(3);
  joint.q = 32;
  joint.tick();
  EXPECT_NEAR(joint.data->sample.q[0], 32, 1e-5);
  joint.encoder_speaks = false;
  joint.ticks(5);
  ASSERT_EQ(joint.data->fault, Fault::kEncoderSilent);
  joint.encoder_speaks = true;
  ASSERT_TRUE(joint.clear_fault());
  joint.ticks(3);
  EXPECT_NEAR(joint.data->sample.q[0], 32 - hal::kCarriedRangeRad, 1e-5) << "the same in its turn";
}

// GIVEN a protocol that carries all turns WHEN its axis starts anew, and counts from 0, THEN that
// is no turn.
TEST(TurningJoint, TakesNoRestartOfAnAxisForAWrap) {
  for (const float before : {100.0F, -100.0F, 40.0F, 32.2F, -32.2F, 31.5F, -31.5F}) {
    JointOnDesk joint;
    joint.lie = before;
    joint.ticks(5);
    joint.lie = 0.0F;
    joint.ticks(3);
    EXPECT_EQ(joint.data->sample.q[0], 0.0F) << before;
    joint.lie = -0.3F;
    joint.ticks(3);
    EXPECT_EQ(joint.data->sample.q[0], -0.3F) << before;
  }
}

// A joint with limits is where its frames say.
TEST(TurningJoint, IsOneWithoutLimits) {
  auto config = JointOnDesk::config();
  config.monitor.chain.joints[0].min_position = -32;
  config.monitor.chain.joints[0].max_position = 32;
  JointOnDesk joint(config);
  joint.q = 31.9;
  joint.ticks(3);
  joint.q = -31.9;
  joint.tick();
  EXPECT_NEAR(joint.data->sample.q[0], -31.9, 1e-5);
}

}  // namespace
}  // namespace offnominal::test
