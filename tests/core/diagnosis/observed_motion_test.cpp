#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/diagnosis/observed_motion.hpp>
#include <random>
#include <vector>

#include "support/seed.hpp"

namespace offnominal {
namespace {

using ObserverConfig = VelocityObserverConfig<double>;
using MotionState = ObservedMotionState<double>;
using Motion = ObservedMotion<double>;

// Twice through (1 - a) / (1 - a / z), begun as if its first value had been there for long.
struct TwoLowPasses {
  double pole;
  double once;
  double twice;

  double next(double value) {
    once = pole * once + (1 - pole) * value;
    twice = pole * twice + (1 - pole) * once;
    return twice;
  }
};

// GIVEN any positions and torques WHEN they are observed THEN the velocity is to the last digit the
// difference of the position behind two low-passes, and position and torque are the means over that
// tick of what is behind the same two.
TEST(ObservedMotion, IsOneTimeOfPositionVelocityAndTorque) {
  std::mt19937_64 random = test::seeded_generator();
  std::normal_distribution<double> step(0, 1e-3);
  const ObserverConfig config{150, 0.001};
  const double pole = std::exp(-0.15);
  double position = 0.7;
  double torque = -3;
  TwoLowPasses q{pole, position, position};
  TwoLowPasses tau{pole, torque, torque};
  MotionState state;
  Motion motion;
  ASSERT_EQ(observe(config, position, torque, 0, state, motion), Status::kOk);
  EXPECT_EQ(motion.position, position);
  EXPECT_EQ(motion.velocity, 0);
  EXPECT_EQ(motion.torque, torque);
  for (int i = 0; i < 2000; ++i) {
    position += step(random);
    torque += 100 * step(random);
    const double q_before = q.twice;
    const double tau_before = tau.twice;
    const double q_now = q.next(position);
    const double tau_now = tau.next(torque);
    ASSERT_EQ(observe(config, position, torque, 0, state, motion), Status::kOk);
    ASSERT_NEAR(motion.position, (q_now + q_before) / 2, 1e-12) << i;
    ASSERT_NEAR(motion.velocity, (q_now - q_before) / config.period_s, 1e-9) << i;
    ASSERT_NEAR(motion.torque, (tau_now + tau_before) / 2, 1e-12) << i;
  }
}

// GIVEN a joint of one inertia that a torque moves as it likes WHEN momentum and the torque's sum
// are compared THEN nothing is between them beside the positions as they were observed, where
// beside torque and velocity of now there are 2 a / bandwidth.
TEST(ObservedMotion, LeavesNothingOfAnAcceleration) {
  const ObserverConfig config{200, 0.001};
  constexpr double kInertia = 0.8;
  MotionState state;
  Motion motion;
  double q = 0;
  double dq = 0;
  double sum = 0;
  double worst = 0;
  double worst_of_now = 0;
  double sum_of_now = 0;
  for (int i = 0; i < 4000; ++i) {
    // Held over the tick that ends with the sample.
    const double torque = i < 100 ? 0 : 10 * std::sin(0.01 * i);
    const double before = dq;
    dq += config.period_s * torque / kInertia;
    q += config.period_s * (before + dq) / 2;
    ASSERT_EQ(observe(config, q, torque, 0, state, motion), Status::kOk);
    sum += config.period_s * motion.torque;
    sum_of_now += config.period_s * torque;
    worst = std::max(worst, std::fabs(kInertia * motion.velocity - sum));
    worst_of_now = std::max(worst_of_now, std::fabs(kInertia * motion.velocity - sum_of_now));
  }
  EXPECT_GT(worst_of_now, 0.9 * kInertia * 2 * (10 / kInertia) / config.bandwidth_rad_s);
  EXPECT_LT(worst, worst_of_now / 1000);
}

// What was not seen is bridged by the observer; the torque goes on meanwhile with what it is now.
TEST(ObservedMotion, BridgesAGapOfAConstantVelocityWithoutError) {
  const ObserverConfig config{200, 0.001};
  MotionState state;
  Motion motion;
  for (int i = 0; i < 400; ++i) {
    ASSERT_EQ(observe(config, 2e-3 * i, 1.0, 0, state, motion), Status::kOk);
  }
  ASSERT_EQ(observe(config, 2e-3 * 404, 1.0, 4, state, motion), Status::kOk);
  EXPECT_NEAR(motion.velocity, 2, 1e-6);
  EXPECT_NEAR(motion.torque, 1, 1e-12);
  MotionState other = state;
  Motion stepped;
  ASSERT_EQ(observe(config, 2e-3 * 409, 3.0, 4, state, motion), Status::kOk);
  for (int i = 405; i < 410; ++i) {
    ASSERT_EQ(observe(config, 2e-3 * i, 3.0, 0, other, stepped), Status::kOk);
  }
  EXPECT_NEAR(motion.torque, stepped.torque, 1e-12);
  EXPECT_NEAR(motion.position, stepped.position, 1e-9);
}

// Behind a gap that is too long what was is forgotten.
TEST(ObservedMotion, BeginsAnewWithItsTorque) {
  const ObserverConfig config{200, 0.001};
  MotionState state;
  Motion motion;
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(observe(config, 0.0, 5.0, 0, state, motion), Status::kOk);
  }
  ASSERT_EQ(observe(config, 1.0, -4.0, 6, state, motion), Status::kOk);
  EXPECT_EQ(state.observer.updates, 1U);
  EXPECT_EQ(motion.position, 1);
  EXPECT_EQ(motion.velocity, 0);
  EXPECT_EQ(motion.torque, -4);
}

TEST(ObservedMotion, LeavesEverythingAsItWasWhereThePositionIsNone) {
  const ObserverConfig config{200, 0.001};
  MotionState state;
  Motion motion;
  ASSERT_EQ(observe(config, 0.1, 5.0, 0, state, motion), Status::kOk);
  const MotionState before = state;
  const Motion was = motion;
  EXPECT_EQ(observe(config, std::numeric_limits<double>::quiet_NaN(), 1.0, 0, state, motion),
            Status::kNonFinitePosition);
  EXPECT_EQ(state.torque_once, before.torque_once);
  EXPECT_EQ(state.observer.updates, before.observer.updates);
  EXPECT_EQ(motion.torque, was.torque);
}

}  // namespace
}  // namespace offnominal
