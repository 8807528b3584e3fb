// Where the velocity observer begins, how far its promises go, and its bound to the last digits.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <offnominal/diagnosis/velocity_observer.hpp>

namespace offnominal {
namespace {

using Config = VelocityObserverConfig<double>;
using State = VelocityObserverState<double>;

// A quarter, without rounding.
constexpr Config kQuarter{.bandwidth_rad_s = 128, .period_s = 1.0 / 512};

TEST(VelocityObserverLimits, ItRunsAt200RadPerSecondEveryMillisecondUnlessToldOtherwise) {
  EXPECT_EQ(Config{}.bandwidth_rad_s, 200);
  EXPECT_EQ(Config{}.period_s, 0.001);
}

TEST(VelocityObserverLimits, ItStartsAtRestWhereTheJointIs) {
  for (const std::uint32_t missed : {0U, 1000U}) {
    State state;
    EXPECT_EQ(state.updates, 0U);
    EXPECT_EQ(state.velocity, 0);
    ASSERT_EQ(update(Config{}, 5.0, state, missed), Status::kOk);
    EXPECT_EQ(state.updates, 1U);
    EXPECT_EQ(state.position, 5.0);
    EXPECT_EQ(state.velocity, 0);
  }
}

TEST(VelocityObserverLimits, AGapOfOneOverTheBandwidthIsTheLongestThatIsBridged) {
  State bridged{1000, 0, 3};
  const double position = 3 * 5 * kQuarter.period_s;
  ASSERT_EQ(update(kQuarter, position, bridged, 4), Status::kOk);
  EXPECT_EQ(bridged.updates, 1001U);
  EXPECT_EQ(bridged.velocity, 3);
  EXPECT_EQ(bridged.position, position);
  State forgotten{1000, 0, 3};
  ASSERT_EQ(update(kQuarter, 1.5, forgotten, 5), Status::kOk);
  EXPECT_EQ(forgotten.updates, 1U);
  EXPECT_EQ(forgotten.velocity, 0);
  EXPECT_EQ(forgotten.position, 1.5);
}

TEST(VelocityObserverLimits, ItHasSettledAfterNineAndAQuarterTimeConstants) {
  EXPECT_FALSE(is_settled(kQuarter, State{37, 0, 0}));
  EXPECT_TRUE(is_settled(kQuarter, State{38, 0, 0}));
}

TEST(VelocityObserverLimits, ItsLoopIsFasterThanNothingAndSlowerThanHalfItsSampling) {
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = 256, .period_s = 1.0 / 512}),
            Status::kInvalidFilterPole);
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = 255.9, .period_s = 1.0 / 512}), Status::kOk);
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = -1}), Status::kInvalidFilterPole);
  EXPECT_EQ(validate(Config{.bandwidth_rad_s = 1e-9}), Status::kOk);
  for (const double period_s : {-0.001, 0.0, std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(validate(Config{.period_s = period_s}), Status::kInvalidPeriod) << period_s;
  }
}

// A position that is off once, by one: what the observer itself makes of it, as velocities, added
// up without their signs. With this pole the velocity's error goes through zero at a tick while the
// position's is still large.
TEST(VelocityObserverLimits, ThePositionsShareOfTheBoundIsWhatTheObserverMakesOfIt) {
  const Config config{.bandwidth_rad_s = -std::log(0.75) / 1e-4, .period_s = 1e-4};
  State state{1, 0, 0};
  double sum = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_EQ(update(config, tick == 0 ? 1.0 : 0.0, state), Status::kOk);
    sum += std::fabs(state.velocity);
  }
  EXPECT_NEAR(velocity_error_bound(config, 0.0, 1.0), sum, 1e-6 * sum);
  EXPECT_NEAR(velocity_error_bound(config, 0.0, 0.25), 0.25 * sum, 1e-6 * sum);
}

// A slow loop over a long period: its lag would be of the size of what a position makes of it.
TEST(VelocityObserverLimits, ThePositionsShareOfTheBoundHoldsNoLag) {
  const Config config{.bandwidth_rad_s = 1, .period_s = 0.25};
  State state{1, 0, 0};
  double sum = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    ASSERT_EQ(update(config, tick == 0 ? 1.0 : 0.0, state), Status::kOk);
    sum += std::fabs(state.velocity);
  }
  EXPECT_NEAR(velocity_error_bound(config, 0.0, 1.0), sum, 1e-5 * sum);
}

// The same of an acceleration of one for one tick.
TEST(VelocityObserverLimits, TheAccelerationsShareOfTheBoundIsWhatTheObserverLags) {
  const Config config{.bandwidth_rad_s = 150};
  State state{1, 0, 0};
  const double step = config.period_s;  // of the velocity
  double sum = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    const double position = step * config.period_s * (0.5 + tick);
    ASSERT_EQ(update(config, position, state), Status::kOk);
    sum += std::fabs(step - state.velocity);
  }
  EXPECT_NEAR(velocity_error_bound(config, 1.0, 0.0), sum, 1e-6 * sum);
  EXPECT_NEAR(velocity_error_bound(config, 8.0, 0.0), 8 * sum, 8e-6 * sum);
}

TEST(VelocityObserverLimits, TheBoundOfALoopThatIsNoneIsNoNumber) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(velocity_error_bound(Config{.bandwidth_rad_s = none}, 1.0, 1.0)));
}

}  // namespace
}  // namespace offnominal
