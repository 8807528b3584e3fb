// Ticks without a sample: what resume() promises.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

#include "core/monitor_of.hpp"

namespace offnominal::test {
namespace {

template <typename Scalar>
using MonitorGap = MonitorOf<Scalar>;
TYPED_TEST_SUITE(MonitorGap, Scalars);

struct GapRun {
  int alarms = 0;
  int gaps = 0;
};

// A run over which every tenth tick or so is followed by up to 20 without a sample; `told` says
// whether the monitor learns of them. Velocities are wrong by `velocity_error` in any direction.
template <typename Scalar>
GapRun run_with_gaps(const typename WatchedArm<Scalar>::Watch& monitor,
                     typename WatchedArm<Scalar>::Watch::State& state, double fault, bool told,
                     double velocity_error = 0) {
  std::mt19937_64 generator = seeded_generator();
  std::uniform_int_distribution<std::uint32_t> draw_gap(1, 20);
  WatchedArm<Scalar> arm;
  const auto measured = [&](double gap_s) {
    auto sample = arm.move(gap_s, fault);
    const Eigen::Vector2d direction = random_direction(generator).template head<2>().normalized();
    sample.dq += (velocity_error * direction).cast<Scalar>();
    return sample;
  };
  typename WatchedArm<Scalar>::Watch::Output output;
  GapRun run;
  EXPECT_EQ(monitor.reset(arm.sample(), state), Status::kOk);
  for (int i = 0; i < 4000; ++i) {
    if (draw_gap(generator) <= 2) {
      const std::uint32_t missed = draw_gap(generator);
      const auto sample = measured(0.001 * (missed + 1));
      const Status status =
          told ? monitor.resume(sample, missed, state) : monitor.step(sample, state, output);
      EXPECT_EQ(status, Status::kOk);
      ++run.gaps;
    } else {
      EXPECT_EQ(monitor.step(measured(0.001), state, output), Status::kOk);
      run.alarms += output.detector.level ? 1 : 0;
    }
  }
  EXPECT_GT(run.gaps, 200);
  return run;
}

TYPED_TEST(MonitorGap, GivenAHealthyArmThenGapsRaiseNoAlarmOnceTheMonitorKnowsOfThem) {
  EXPECT_EQ(run_with_gaps<TypeParam>(this->monitor, this->state, 0.0, true).alarms, 0);
  EXPECT_GT(run_with_gaps<TypeParam>(this->monitor, this->state, 0.0, false).alarms, 0)
      << "gaps taken for one tick are to look like faults here";
}

TYPED_TEST(MonitorGap, GivenAFaultThenItIsDetectedAndLearntAcrossGaps) {
  run_with_gaps<TypeParam>(this->monitor, this->state, 6.0, true);
  EXPECT_TRUE(this->state.detector.latched);
  EXPECT_NEAR(static_cast<double>(this->state.estimator.psi_hat[0]), 6.0, 2.0);
  EXPECT_NEAR(static_cast<double>(this->state.estimator.psi_hat[1]), -6.0, 2.0);
}

TYPED_TEST(MonitorGap, GivenAVelocityErrorThatTheBoundKnowsThenGapsRaiseNoAlarm) {
  using Watch = typename WatchedArm<TypeParam>::Watch;
  auto config = arm_config<TypeParam>();
  config.bound.velocity_error = TypeParam(0.05);
  Watch tolerant;
  ASSERT_EQ(Watch::create(config, tolerant), Status::kOk);
  EXPECT_EQ(run_with_gaps<TypeParam>(tolerant, this->state, 0.0, true, 0.05).alarms, 0);
}

TYPED_TEST(MonitorGap, KeepsErrorThresholdAndTimeAndRefusesLikeAStep) {
  WatchedArm<TypeParam> arm;
  auto sample = arm.sample();
  EXPECT_EQ(this->monitor.resume(sample, 3, this->state), Status::kNotInitialised);
  ASSERT_EQ(this->monitor.reset(sample, this->state), Status::kOk);
  for (int tick = 0; tick < 100; ++tick) {
    ASSERT_EQ(this->monitor.step(arm.move(0.001, 4.0), this->state, this->output), Status::kOk);
  }
  sample = arm.move(0.004, 4.0);
  auto broken = sample;
  broken.q[0] = std::numeric_limits<TypeParam>::quiet_NaN();
  const auto before = this->state;
  EXPECT_NE(this->monitor.resume(broken, 3, this->state), Status::kOk);
  EXPECT_EQ(this->state.tick, 100U);

  ASSERT_EQ(this->monitor.resume(sample, 3, this->state), Status::kOk);
  EXPECT_EQ(this->state.tick, 104U);
  EXPECT_EQ(this->state.estimator.mu, before.estimator.mu);
  const auto error = (sample.dq - this->state.estimator.omega).eval();
  EXPECT_NEAR(static_cast<double>((error - before.estimator.error).norm()), 0.0, 1e-6);
  EXPECT_EQ(this->state.estimator.weights.w1, before.estimator.weights.w1);
}

}  // namespace
}  // namespace offnominal::test
