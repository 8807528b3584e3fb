#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <random>

#include "support/seed.hpp"

namespace offnominal {
namespace {

using Config = VelocityObserverConfig<double>;
using State = VelocityObserverState<double>;

double error_after(const Config& config, double acceleration, int ticks) {
  State state;
  double position = 0;
  double velocity = 0;
  for (int i = 0; i < ticks; ++i) {
    EXPECT_EQ(update(config, position, state), Status::kOk);
    position += config.period_s * velocity + acceleration * config.period_s * config.period_s / 2;
    velocity += acceleration * config.period_s;
  }
  return velocity - acceleration * config.period_s - state.velocity;
}

TEST(VelocityObserver, FollowsAConstantVelocityWithoutError) {
  const Config config;
  State state;
  for (int i = 0; i < 200; ++i) {
    ASSERT_EQ(update(config, 3.0 * config.period_s * i, state), Status::kOk);
  }
  EXPECT_NEAR(state.velocity, 3.0, 1e-9);
}

TEST(VelocityObserver, LagsAConstantAccelerationByWhatItsBoundSays) {
  const Config config;
  const double lag = error_after(config, 5.0, 2000);
  EXPECT_GT(lag, 0.0);
  EXPECT_NEAR(velocity_error_bound(config, 5.0, 0.0), lag, 1e-6 * lag);
  EXPECT_NEAR(lag, 2 * 5.0 / config.bandwidth_rad_s, 0.15 * lag) << "2 a / w in continuous time";
}

// GIVEN positions that are off by up to half a count and a motion within its acceleration WHEN the
// observer has settled THEN its error stays within the bound, and comes near it where the errors
// are as bad as they can be.
TEST(VelocityObserver, StaysWithinItsBound) {
  const Config config{.bandwidth_rad_s = 150};
  const double half_count = 1e-4;
  const double most = 4.0;
  const double bound = velocity_error_bound(config, most, half_count);
  std::mt19937_64 random = test::seeded_generator();
  std::bernoulli_distribution up(0.5);
  State state;
  double position = 0;
  double velocity = 0;
  double worst = 0;
  double acceleration = most;
  for (int i = 0; i < 20000; ++i) {
    const double noise = up(random) ? half_count : -half_count;
    ASSERT_EQ(update(config, position + noise, state), Status::kOk);
    if (i > 200) worst = std::max(worst, std::fabs(velocity - state.velocity));
    // Bang-bang within speeds that keep the position small.
    if (std::fabs(velocity) > 2.0) acceleration = velocity > 0 ? -most : most;
    position += config.period_s * velocity + acceleration * config.period_s * config.period_s / 2;
    velocity += acceleration * config.period_s;
  }
  EXPECT_LE(worst, bound);
  EXPECT_GT(worst, 0.4 * bound);
}

TEST(VelocityObserver, RefusesWhatItCannotFollow) {
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = 0}), Status::kInvalidFilterPole);
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = 500}), Status::kInvalidFilterPole);
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = 200, .period_s = 0}), Status::kInvalidPeriod);
  EXPECT_EQ(validate(Config{}), Status::kOk);
  State state{1, 1, 2};
  EXPECT_EQ(update(Config{}, std::numeric_limits<double>::quiet_NaN(), state),
            Status::kNonFinitePosition);
  EXPECT_EQ(state.velocity, 2);
}

// Whatever speed the joint had when it was first looked at: 0.2 % of it is left when the observer
// says that it has settled, and it does not take long to say so.
TEST(VelocityObserver, SaysWhenItHasForgottenItsStart) {
  for (const double bandwidth : {20.0, 200.0, 450.0}) {
    const Config config{.bandwidth_rad_s = bandwidth};
    State state;
    int ticks = 0;
    for (; !is_settled(config, state); ++ticks) {
      ASSERT_EQ(update(config, 3.0 * config.period_s * ticks, state), Status::kOk);
    }
    EXPECT_NEAR(state.velocity, 3.0, 0.002 * 3.0) << bandwidth;
    EXPECT_GT(std::fabs(state.velocity - 3.0), 1e-5 * 3.0) << "waits too long, " << bandwidth;
    EXPECT_NEAR(ticks * bandwidth * config.period_s, 9.25, 0.5);
  }
}

TEST(VelocityObserver, BridgesAShortGapAndForgetsALongOne) {
  const Config config;
  State state;
  int tick = 0;
  const auto see = [&](int missed) {
    tick += missed;
    const Status status =
        update(config, 3.0 * config.period_s * tick, state, static_cast<std::uint32_t>(missed));
    ++tick;
    return status;
  };
  for (int i = 0; i < 200; ++i) ASSERT_EQ(see(0), Status::kOk);
  ASSERT_EQ(see(4), Status::kOk);
  EXPECT_NEAR(state.velocity, 3.0, 1e-9) << "the position has gone on";
  EXPECT_TRUE(is_settled(config, state));
  ASSERT_EQ(see(6), Status::kOk);
  EXPECT_EQ(state.velocity, 0);
  EXPECT_FALSE(is_settled(config, state));
}

TEST(VelocityObserver, NeverHoldsAVelocityThatIsNoNumber) {
  using Float = VelocityObserverState<float>;
  Float state{100, 0, 1};
  EXPECT_EQ(update(VelocityObserverConfig<float>{}, 3e38F, state), Status::kNumericOverflow);
  EXPECT_EQ(state.velocity, 1);
  EXPECT_EQ(state.updates, 100U);
  Float old{std::numeric_limits<std::uint32_t>::max(), 0, 0};
  EXPECT_EQ(update(VelocityObserverConfig<float>{}, 0.0F, old), Status::kOk);
  EXPECT_TRUE(is_settled(VelocityObserverConfig<float>{}, old)) << "after 49 days";
}

}  // namespace
}  // namespace offnominal
