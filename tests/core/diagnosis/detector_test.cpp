#include <gtest/gtest.h>

#include <limits>
#include <offnominal/diagnosis/detector.hpp>
#include <random>

#include "core/model/random_chain.hpp"
#include "support/seed.hpp"

namespace offnominal::test {
namespace {

TEST(Detector, GivenAnErrorBelowOrAtTheThresholdThenNothingIsDetected) {
  DetectorState<double> state;
  update(state, 0.0 > 0.0, 1U, 0.001);
  EXPECT_FALSE(state.level);
  update(state, 0.5 > 0.5, 2U, 0.002);
  EXPECT_FALSE(state.level);
  EXPECT_FALSE(state.latched);
}

TEST(Detector, GivenACrossingThenTheLevelFallsBackAndTheLatchStaysWithTheFirstTime) {
  DetectorState<double> state;
  update(state, 0.6 > 0.5, 7U, 0.007);
  EXPECT_TRUE(state.level);
  EXPECT_TRUE(state.latched);
  update(state, 0.4 > 0.5, 8U, 0.008);
  EXPECT_FALSE(state.level);
  EXPECT_TRUE(state.latched);
  update(state, 0.9 > 0.5, 9U, 0.009);
  EXPECT_TRUE(state.level);
  EXPECT_EQ(state.detection_tick, 7U);
  EXPECT_EQ(state.detection_time_s, 0.007);
}

TEST(Detector, GivenAClearedLatchThenTheNextCrossingLatchesWithItsOwnTime) {
  DetectorState<float> state;
  update(state, 0.6F > 0.5F, 7U, 0.007);
  clear_latch(state);
  EXPECT_FALSE(state.latched);
  EXPECT_TRUE(state.level) << "clearing the latch does not deny what is so now";
  update(state, 0.4F > 0.5F, 8U, 0.008);
  EXPECT_FALSE(state.latched);
  update(state, 0.6F > 0.5F, 9U, 0.009);
  EXPECT_TRUE(state.latched);
  EXPECT_EQ(state.detection_tick, 9U);
  EXPECT_EQ(state.detection_time_s, 0.009);
}

TEST(Detector, GivenAClearedLatchWhileTheFaultLastsThenTheNextTickLatchesAgain) {
  DetectorState<double> state;
  update(state, 0.6 > 0.5, 7U, 0.007);
  clear_latch(state);
  update(state, 0.6 > 0.5, 8U, 0.008);
  EXPECT_TRUE(state.latched);
  EXPECT_EQ(state.detection_tick, 8U);
}

// Random walk of updates and clearings against a history that is searched anew every time.
TEST(Detector, FollowsItsRulesUnderRandomUse) {
  std::mt19937_64 generator = seeded_generator();
  DetectorState<double> state;
  std::uint32_t first_crossing = 0;  // since the last clearing, 0: none
  for (std::uint32_t tick = 1; tick <= 100000; ++tick) {
    const double error = uniform(generator, 0, 1);
    const double mu = uniform(generator, 0.5, 1.2);
    update(state, error > mu, tick, 0.001 * tick);
    if (error > mu && first_crossing == 0) first_crossing = tick;
    ASSERT_EQ(state.level, error > mu);
    ASSERT_EQ(state.latched, first_crossing != 0);
    if (state.latched) {
      ASSERT_EQ(state.detection_tick, first_crossing);
      ASSERT_EQ(state.detection_time_s, 0.001 * first_crossing);
    }
    if (uniform(generator, 0, 1) < 0.05) {
      clear_latch(state);
      first_crossing = 0;
      ASSERT_FALSE(state.latched);
    }
  }
}

}  // namespace
}  // namespace offnominal::test
