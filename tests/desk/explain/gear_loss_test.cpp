#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "compare/compare.hpp"
#include "compare/measurement.hpp"
#include "explain/add_found.hpp"
#include "serial_arm.hpp"

// A gear that loses more where it is driven back than where it drives, on an arm whose weight does
// both.

namespace offnominal::desk {
namespace {

using ::testing::IsEmpty;
using ::testing::Not;

ExplainOptions quick_options() {
  ExplainOptions options;
  options.bootstrap_draws = 199;
  options.replays = 0;
  options.threads = 2;
  return options;
}

RobotDescription with_gear(double driven_loss, double driving_loss) {
  RobotDescription real = test::serial_arm(2);
  real.effects.push_back(
      test::effect_of(EffectKind::kGearLoss, 1, {driven_loss, driving_loss, 0.01}, true));
  return real;
}

void expect_interval_holds(const Estimate& found, const std::string& name, double truth) {
  EXPECT_EQ(found.value.name, name);
  ASSERT_TRUE(found.ci95) << found.why_no_interval;
  EXPECT_LT((*found.ci95)[0], truth) << name;
  EXPECT_GT((*found.ci95)[1], truth) << name;
  EXPECT_LT((*found.ci95)[1] - (*found.ci95)[0], 0.2) << name;
}

TEST(GearLoss, IsFoundAndWrittenWithBothItsLosses) {
  const RobotDescription real = with_gear(0.4, 0.1);
  const Log log = test::record(real, {.duration_s = 40});
  const AddedFindings added = add_found(test::serial_arm(2), {log}, {}, quick_options(), {});
  const Explanation& told = added.explanation;
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kGearLoss, 1})) << told.words;
  EXPECT_THAT(told.ambiguous, IsEmpty()) << told.words;
  expect_interval_holds(told.found[0].parameters.at(0), "driven_loss", 0.4);
  expect_interval_holds(told.found[0].parameters.at(1), "driving_loss", 0.1);
  EXPECT_TRUE(added.may_be_written(false)) << told.words;
  EXPECT_EQ(told.improved.effects.back().kind, EffectKind::kGearLoss);
  // The file that is written needs the torque that was recorded, but for its noise and for a sign
  // that is as wide as the recording resolves.
  const Measurement measured = measure(log, real);
  EXPECT_LT(compare(told.improved, measured).joints.at(1).rms_error,
            1.2 * compare(real, measured).joints.at(1).rms_error);
}

// One number less says the same: equal losses are friction by the load.
TEST(GearLoss, OfEqualLossesIsCalledLoadDependentFriction) {
  const Explanation told =
      explain(test::serial_arm(2), {test::record(with_gear(0.25, 0.25), {.duration_s = 40})}, {},
              quick_options());
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kLoadDependentFriction, 1})) << told.words;
  EXPECT_THAT(told.ambiguous, IsEmpty()) << told.words;
}

}  // namespace
}  // namespace offnominal::desk
