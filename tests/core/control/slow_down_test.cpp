#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <offnominal/control/slow_down.hpp>

namespace offnominal {
namespace {

Reference<2, double> swing_at(double time_s) {
  Reference<2, double> reference;
  reference.q << std::sin(3 * time_s), 0.4 * std::cos(5 * time_s);
  reference.dq << 3 * std::cos(3 * time_s), -2 * std::sin(5 * time_s);
  reference.ddq << -9 * std::sin(3 * time_s), -10 * std::cos(5 * time_s);
  return reference;
}

constexpr double kSlowedAt = 0.7;

Reference<2, double> slowed_at(const SlowDownConfig<double>& config, double time_s) {
  const Pace<double> pace = pace_of(config, time_s - kSlowedAt);
  Reference<2, double> reference = swing_at(time_s - pace.behind_s);
  slow_down(pace, reference);
  return reference;
}

TEST(SlowDown, BeginsWithTheReferenceAsItIs) {
  const SlowDownConfig<double> config;
  const auto begin = slowed_at(config, kSlowedAt);
  const auto as_it_is = swing_at(kSlowedAt);
  EXPECT_EQ(begin.q, as_it_is.q);
  EXPECT_EQ(begin.dq, as_it_is.dq);
  EXPECT_EQ(begin.ddq, as_it_is.ddq) << "a torque that jumps";
}

TEST(SlowDown, VelocityAndAccelerationAreDerivatives) {
  constexpr double kStep = 1e-6;
  for (const double to : {0.0, 0.25, 0.9}) {
    for (const double within_s : {0.05, 0.8}) {
      const SlowDownConfig<double> config{to, within_s};
      for (double time_s = kSlowedAt + 0.001; time_s < kSlowedAt + 2; time_s += 0.0137) {
        const auto before = slowed_at(config, time_s - kStep);
        const auto now = slowed_at(config, time_s);
        const auto after = slowed_at(config, time_s + kStep);
        EXPECT_LT(((after.q - before.q) / (2 * kStep) - now.dq).norm(), 1e-7) << time_s;
        EXPECT_LT(((after.dq - before.dq) / (2 * kStep) - now.ddq).norm(), 2e-4) << time_s;
      }
    }
  }
}

// Of the acceleration too: what follows it does not jump, at either end of the slowing.
TEST(SlowDown, NothingJumps) {
  constexpr double kStep = 1e-6;
  const SlowDownConfig<double> config{0.2, 0.4};
  for (const double time_s : {kSlowedAt, kSlowedAt + 0.2, kSlowedAt + 0.4}) {
    const auto before = slowed_at(config, time_s - (time_s > kSlowedAt ? kStep : 0));
    const auto after = slowed_at(config, time_s + kStep);
    EXPECT_LT((after.ddq - before.ddq).norm(), 1e-3) << time_s;
  }
}

TEST(SlowDown, ThePaceFallsNoFasterThanItMayAndStaysWhereItShall) {
  const SlowDownConfig<double> config{0.3, 0.5};
  EXPECT_DOUBLE_EQ(largest_pace_rate(config), 2.1);
  double last = 1;
  double fastest = 0;
  for (double since_s = 0; since_s < 3; since_s += 0.001) {
    const Pace<double> pace = pace_of(config, since_s);
    EXPECT_LE(pace.share, last);
    EXPECT_GE(pace.share, config.to - 1e-15);
    EXPECT_LE(pace.rate, 0);
    fastest = std::max(fastest, -pace.rate);
    last = pace.share;
  }
  EXPECT_LE(fastest, largest_pace_rate(config));
  EXPECT_GT(fastest, 0.99 * largest_pace_rate(config));
  EXPECT_DOUBLE_EQ(last, config.to);
}

// What a sum of many small steps comes to.
TEST(SlowDown, TheTimeIsTheIntegralOfThePace) {
  for (const double to : {0.0, 0.5}) {
    const SlowDownConfig<double> config{to, 0.6};
    constexpr double kStep = 1e-4;
    double behind_s = 0;
    for (int i = 0; i < 20000; ++i) {
      behind_s += kStep * (1 - pace_of(config, (i + 0.5) * kStep).share);
    }
    EXPECT_NEAR(pace_of(config, 20000 * kStep).behind_s, behind_s, 1e-7);
  }
}

TEST(SlowDown, ToNothingItComesToAStandOnItsPath) {
  const SlowDownConfig<double> config{0, 0.5};
  const auto stand = slowed_at(config, kSlowedAt + 0.5);
  EXPECT_EQ(stand.dq.norm(), 0);
  EXPECT_EQ(stand.ddq.norm(), 0);
  // Half of what it takes is on the way.
  EXPECT_LT((stand.q - swing_at(kSlowedAt + 0.25).q).norm(), 1e-12);
  EXPECT_LT((slowed_at(config, 1000.0).q - stand.q).norm(), 1e-9);
}

// A year later, in a float.
TEST(SlowDown, GivenFloatsThenItsTimeStaysExact) {
  const SlowDownConfig<float> config{0.5F, 1.0F};
  const double year_s = 365.0 * 86400;
  const double step_s = pace_of(config, year_s + 0.001).behind_s - pace_of(config, year_s).behind_s;
  EXPECT_NEAR(step_s, 0.0005, 1e-8);
}

TEST(SlowDown, IsRefusedWhereItSlowsNothingOrCannot) {
  EXPECT_EQ(validate(SlowDownConfig<float>{}), Status::kOk);
  EXPECT_EQ(validate(SlowDownConfig<float>{0.0F, 0.1F}), Status::kOk);
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (const float to : {-0.1F, 1.0F, none}) {
    EXPECT_EQ(validate(SlowDownConfig<float>{to, 1.0F}), Status::kInvalidLimit) << to;
  }
  for (const float within_s : {0.0F, -1.0F, none}) {
    EXPECT_EQ(validate(SlowDownConfig<float>{0.5F, within_s}), Status::kInvalidLimit) << within_s;
  }
}

}  // namespace
}  // namespace offnominal
