#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <offnominal/diagnosis/encoder_watch.hpp>

// Positions that no joint goes through, and how long one stands while others move.

namespace offnominal::test {
namespace {

// A joint at a rate of samples, on a sine of 0.5 rad and 2 rad/s, read to a count.
struct MovingReading {
  double rate_hz = 1000;
  double at_s = 10.25;  // when something happens to it
  double jump = 0;      // rad, of its reading

  [[nodiscard]] double reading(std::uint32_t sample) const {
    const double t = sample / rate_hz;
    const double count = 1e-5;
    return count * std::round((0.5 * std::sin(2 * t) + (t >= at_s ? jump : 0)) / count);
  }
  [[nodiscard]] EncoderWatch<double> watched(double seconds) const {
    EncoderWatch<double> watch;
    for (std::uint32_t i = 0; i < seconds * rate_hz; ++i) look_at(watch, reading(i));
    return watch;
  }
};

bool has_jumped(const EncoderWatch<double>& watch) { return watch.since_jump < 1000; }

TEST(EncoderWatch, SeesAJumpAtAnyRateOfSamples) {
  for (const double rate_hz : {100.0, 250.0, 1000.0, 2000.0}) {
    const auto watch = MovingReading{.rate_hz = rate_hz, .jump = 0.03}.watched(10.4);
    EXPECT_TRUE(has_jumped(watch)) << rate_hz << " Hz";
    EXPECT_NEAR(watch.jump, 0.03, 0.003) << rate_hz << " Hz";
    EXPECT_FALSE(has_jumped(MovingReading{.rate_hz = rate_hz}.watched(10.4))) << rate_hz << " Hz";
  }
}

// What the encoder says is refused for two ticks, and then taken: elsewhere by more than the joint
// ever went in as many. A joint that only moved on is where it can be.
TEST(EncoderWatch, SeesAJumpOverTicksThatWereRefused) {
  for (const double jump : {0.0, 0.1}) {
    const MovingReading joint{.rate_hz = 250, .jump = jump};
    EncoderWatch<double> watch = MovingReading{.rate_hz = 250}.watched(10.24);
    look_at(watch, joint.reading(2564), 5);
    for (std::uint32_t i = 2565; i < 2600; ++i) look_at(watch, joint.reading(i));
    EXPECT_EQ(has_jumped(watch), jump > 0);
    if (jump > 0) {
      EXPECT_NEAR(watch.jump, jump, 0.03);
    }
  }
}

// A brake that takes hold while nobody looks.
TEST(EncoderWatch, TakesNoStopOverTicksWithoutASampleForAJump) {
  const MovingReading joint{};
  EncoderWatch<double> watch = joint.watched(9.45);  // near the middle of its way, at full speed
  const double held = joint.reading(9452);
  look_at(watch, held, 8);
  for (int i = 0; i < 20; ++i) look_at(watch, held);
  EXPECT_FALSE(has_jumped(watch));
}

// A jump of less than the way of a tick at the highest speed, 0.01 rad here: only a reading goes on
// as before. A joint that is knocked into another speed does not.
TEST(EncoderWatch, TellsASmallJumpFromAKnock) {
  const auto jumps = MovingReading{.rate_hz = 100, .jump = 0.008}.watched(10.4);
  EXPECT_TRUE(has_jumped(jumps));
  EXPECT_NEAR(jumps.jump, 0.008, 0.001);
  EncoderWatch<double> watch;
  const MovingReading joint{.rate_hz = 100};
  for (std::uint32_t i = 0; i < 1040; ++i) {
    const double knocked = i < 1025 ? 0.0 : 0.004 * std::min(i - 1024U, 2U);
    look_at(watch, joint.reading(i) + knocked);
  }
  EXPECT_FALSE(has_jumped(watch));
}

// One count of a joint that has rested since the watch began is beyond all that it ever did.
TEST(EncoderWatch, DoesNotTakeTheCountsOfAJointThatRestsForJumps) {
  EncoderWatch<double> watch;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    look_at(watch, i % 500 == 499 ? 1e-5 : 0.0);
    EXPECT_FALSE(has_jumped(watch)) << "sample " << i;
  }
}

TEST(EncoderWatch, CountsHowLongAJointStandsWhileOthersMove) {
  Standing standing;
  const auto count = [&](int samples, bool stands, bool others_move, bool healthy) {
    for (int i = 0; i < samples; ++i) count_alone(standing, stands, others_move, healthy);
  };
  count(50, true, false, true);
  EXPECT_EQ(standing.alone, 0) << "the whole arm rests";
  count(30, true, true, true);
  EXPECT_EQ(standing.alone, 30);
  EXPECT_EQ(standing.longest_alone, 0) << "it may be the fault that begins";
  count(1, false, true, true);
  EXPECT_EQ(standing.alone, 0);
  EXPECT_EQ(standing.longest_alone, 30);
  count(90, true, true, false);
  count(1, false, true, false);
  EXPECT_EQ(standing.longest_alone, 30) << "after a detection nothing is learnt";
}

// Where samples are refused, as those of an arm that runs away are, time goes on for what stands.
TEST(EncoderWatch, CountsTheTicksWithoutASampleOfAJointThatStands) {
  EncoderWatch<double> watch = MovingReading{}.watched(10);
  const double held = watch.q[watch.newest];
  for (int i = 0; i < 20; ++i) look_at(watch, held);
  EXPECT_TRUE(watch.stopped);
  const std::uint32_t before = watch.still;
  look_at(watch, held, 300);
  look_at(watch, held);
  EXPECT_EQ(watch.still, before + 301);
  EXPECT_TRUE(watch.stopped);
  look_at(watch, held + 0.01, 5);
  EXPECT_EQ(watch.still, 0U);
  EXPECT_FALSE(watch.stopped);
}

// What is locked gives way by a count now and then: it stands, though not to the count.
TEST(EncoderWatch, CallsAJointSlowThatCreepsByCounts) {
  EncoderWatch<double> watch = MovingReading{}.watched(10);
  EXPECT_EQ(watch.slow_for, 0U);
  const double held = watch.q[watch.newest];
  for (int i = 1; i <= 40; ++i) look_at(watch, held + 1e-5 * std::floor(i / 5.0));
  EXPECT_LT(watch.still, kEncoderLag);
  EXPECT_GT(watch.slow_for, 0U);
}

}  // namespace
}  // namespace offnominal::test
