// What `explain` finds can be written into the robot file; it is then part of the model and not
// found a second time.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "discovery/explain.hpp"
#include "hidden_case.hpp"
#include "support/repetitions.hpp"

namespace offnominal::tools::discovery {
namespace {

namespace hidden = sim::hidden;
using test::to_log;
using test::to_robot;

// The candidate's estimates as the parameters of core's effect of the same name.
RobotEffect effect_of(const Finding& finding) {
  for (const EffectInfo& info : kAllEffectInfos) {
    if (finding.what.effect != info.name) continue;
    RobotEffect effect;
    effect.kind = info.kind;
    effect.joint = static_cast<std::uint8_t>(finding.what.joint);
    effect.fitted = true;
    for (std::size_t i = 0; i < info.parameters.size(); ++i) {
      effect.parameters[i] = info.parameters[i].default_value;
      bool named = !info.parameters[i].required;
      for (const Estimate& estimate : finding.parameters) {
        if (estimate.value.name != info.parameters[i].name) continue;
        effect.parameters[i] = estimate.value.value;
        named = true;
      }
      EXPECT_TRUE(named) << info.name << "." << info.parameters[i].name;
    }
    return effect;
  }
  ADD_FAILURE() << finding.what.effect << " is no effect of a robot file";
  return {};
}

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
  ASSERT_EQ(before.found[0].what.effect, hidden::name(GetParam()));
  robot.effects.push_back(effect_of(before.found[0]));
  const Explanation after = explained();
  for (const Finding& again : after.found) {
    EXPECT_FALSE(again.what == before.found[0].what) << after.words;
  }
  const auto joint = static_cast<std::size_t>(before.found[0].what.joint);
  EXPECT_LT(after.joints[joint].rms_before, 0.7 * before.joints[joint].rms_before);
  EXPECT_LT(after.joints[joint].rms_after, 1.2 * before.joints[joint].rms_after);
}

constexpr std::array kNewlyKnown{
    hidden::HiddenEffect::kLoadDependentFriction, hidden::HiddenEffect::kTorqueScale,
    hidden::HiddenEffect::kJointCoupling, hidden::HiddenEffect::kTemperatureDrift};

INSTANTIATE_TEST_SUITE_P(Hidden, FoundEffect, ::testing::ValuesIn(test::every_nth(kNewlyKnown, 3)),
                         [](const auto& parameter) {
                           return std::string(hidden::name(parameter.param));
                         });

}  // namespace
}  // namespace offnominal::tools::discovery
