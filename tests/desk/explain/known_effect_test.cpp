// What `explain` finds can be written into the robot file; it is then part of the model and not
// found a second time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "explain/explain.hpp"
#include "hidden_case.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using test::to_log;
using test::to_robot;

class FoundEffect : public ::testing::TestWithParam<hidden::HiddenEffect> {};

TEST_P(FoundEffect, FitsIntoTheRobotFileAndIsKnownThereafter) {
  const hidden::Case made = test::case_of(5, {GetParam()});
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.threads = 2;
  RobotDescription robot = to_robot(made.nominal);
  const auto explained = [&] {
    return explain(robot, {to_log(made.recording)}, {to_log(made.holdout)}, options);
  };
  const Explanation before = explained();
  ASSERT_FALSE(before.found.empty()) << before.words;
  ASSERT_EQ(before.found[0].what.name(), hidden::name(GetParam()));
  ASSERT_THAT(before.unwritable, ::testing::IsEmpty());
  robot = before.improved;
  const Explanation after = explained();
  for (const Finding& again : after.found) {
    EXPECT_FALSE(again.what == before.found[0].what) << after.words;
  }
  const auto joint = static_cast<std::size_t>(before.found[0].what.joint);
  EXPECT_LT(after.joints[joint].rms_before, 0.7 * before.joints[joint].rms_before);
  EXPECT_LT(after.joints[joint].holdout_fitted, 1.2 * after.joints[joint].holdout_noise_floor)
      << after.words;
}

constexpr std::array kNewlyKnown{
    hidden::HiddenEffect::kLoadDependentFriction, hidden::HiddenEffect::kTorqueScale,
    hidden::HiddenEffect::kJointCoupling, hidden::HiddenEffect::kTemperatureDrift};

INSTANTIATE_TEST_SUITE_P(Hidden, FoundEffect, ::testing::ValuesIn(test::every_nth(kNewlyKnown, 3)),
                         [](const auto& parameter) {
                           return std::string(hidden::name(parameter.param));
                         });

}  // namespace
}  // namespace offnominal::desk
