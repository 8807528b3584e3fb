// The search for a missing effect on simulated robots whose physics is the simulator's own. The
// rates of success are the benchmark's business (./dev bench discovery); here each promise is tried
// on a few robots.

#include "explain/explain.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "explain/explain_report.hpp"
#include "hidden_case.hpp"
#include "serial_arm.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using test::case_of;
using test::to_log;
using test::to_robot;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

ExplainOptions quick() {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.threads = 2;
  return options;
}

Explanation explain_case(const hidden::Case& made, const ExplainOptions& options) {
  return explain(to_robot(made.nominal), {to_log(made.recording)}, {to_log(made.holdout)}, options);
}

// The finding's number of that name; null where it has none.
const Estimate* estimate_of(const std::string& name, const Finding& finding) {
  const auto at = std::find_if(finding.parameters.begin(), finding.parameters.end(),
                               [&name](const Estimate& one) { return one.value.name == name; });
  return at == finding.parameters.end() ? nullptr : &*at;
}

class EachEffect : public ::testing::TestWithParam<hidden::HiddenEffect> {};

TEST_P(EachEffect, IsNamedFirstOnItsJoint) {
  const hidden::Case made = case_of(5, {GetParam()});
  const Explanation result = explain_case(made, quick());
  ASSERT_FALSE(result.found.empty()) << result.words;
  const hidden::TrueEffect& truth = made.truth.effects[0];
  EXPECT_EQ(result.found[0].what.name(), hidden::name(truth.effect));
  EXPECT_EQ(result.found[0].what.joint, truth.joint);
  EXPECT_LE(result.found[0].p_value, 0.01);
  EXPECT_LE(result.found[0].p_replay, 0.05);
  EXPECT_LT(result.found[0].holdout_after, result.found[0].holdout_before);
}

INSTANTIATE_TEST_SUITE_P(Hidden, EachEffect,
                         ::testing::ValuesIn(test::every_nth(hidden::all_hidden_effects(), 4)),
                         [](const auto& parameter) {
                           return std::string(hidden::name(parameter.param));
                         });

// The links' masses are off too, and without the payload a heavier link looks much like it.
TEST(Explain, GIVEN_a_payload_THEN_its_mass_and_place_are_not_taken_for_the_links) {
  const hidden::Case made = case_of(2699507522, {hidden::HiddenEffect::kTipPayload});
  const Explanation result = explain_case(made, quick());
  ASSERT_THAT(result.found, SizeIs(1)) << result.words;
  EXPECT_EQ(result.found[0].what.name(), "tip_payload");
  int compared = 0;
  for (const hidden::TrueParameter& truth : made.truth.effects[0].parameters) {
    const Estimate* found = estimate_of(truth.name, result.found[0]);
    if (found == nullptr) continue;
    EXPECT_NEAR(found->value.value, truth.value, 0.1 * truth.value) << truth.name;
    ++compared;
  }
  EXPECT_GE(compared, 2) << "mass and place";
}

// At 12.4 Hz, above the filter's edge of 12 Hz.
TEST(Explain, GIVEN_a_disturbance_at_the_filters_edge_THEN_it_is_named) {
  const hidden::Case made = case_of(1174567011, {hidden::HiddenEffect::kPeriodicDisturbance});
  const Explanation result = explain_case(made, quick());
  ASSERT_THAT(result.found, SizeIs(1)) << result.words;
  EXPECT_EQ(result.found[0].what.name(), "periodic_disturbance");
  EXPECT_EQ(result.found[0].what.joint, made.truth.effects[0].joint);
  const Estimate* frequency = estimate_of("frequency", result.found[0]);
  ASSERT_NE(frequency, nullptr);
  EXPECT_NEAR(frequency->value.value, 78.0, 0.1) << "rad/s";
}

// Joint 2 is pushed twice, which no effect of the list describes; that is another matter.
TEST(Explain, GIVEN_an_effect_on_one_joint_WHEN_another_is_pushed_THEN_that_does_not_hide_it) {
  const hidden::Case made = case_of(4230267222, {hidden::HiddenEffect::kViscousFriction});
  Log pushed = to_log(made.recording);
  constexpr Eigen::Index kPush = 600;
  const Eigen::ArrayXd push =
      Eigen::ArrayXd::LinSpaced(kPush, 0, std::numbers::pi).sin() * pushed.tau.col(1).maxCoeff();
  for (const Eigen::Index at : {Eigen::Index{9000}, Eigen::Index{20000}}) {
    pushed.tau.col(1).segment(at, kPush).array() += 0.2 * push;
  }
  const Explanation result =
      explain(to_robot(made.nominal), {pushed}, {to_log(made.holdout)}, quick());
  ASSERT_THAT(result.found, SizeIs(1)) << result.words;
  EXPECT_EQ(result.found[0].what, (EffectAt{EffectKind::kViscousFriction, 0}));
  ASSERT_THAT(result.pushes, SizeIs(2)) << result.words;
  for (const Push& one : result.pushes) EXPECT_EQ(one.joints.back().joint, 1);
}

TEST(Explain, GIVEN_nothing_hidden_THEN_nothing_is_found_at_any_noise) {
  struct Noise {
    double share;
    int bits;
  };
  const std::vector<Noise> levels{{0.002, 19}, {0.01, 16}, {0.03, 13}};
  for (const Noise& noise : test::every_nth(levels, 4)) {
    hidden::Request request;
    request.seed = 3;
    request.torque_noise_share = noise.share;
    request.encoder_bits = noise.bits;
    const Explanation result = explain_case(hidden::make_case(request), quick());
    EXPECT_EQ(result.verdict, Verdict::kExplained)
        << noise.bits << " bit: " << result.words << testing::PrintToString(result.advice);
    EXPECT_THAT(result.found, IsEmpty());
    for (const JointErrors& joint : result.joints) {
      EXPECT_LT(joint.rms_after, 1.5 * joint.noise_floor);
      EXPECT_LT(joint.holdout_fitted, 1.2 * joint.holdout_noise_floor);
    }
  }
}

// Its torque is more than chance on the whole recording, and too little for a name on the held-out
// one.
TEST(Explain, GIVEN_an_effect_that_noise_hides_THEN_it_is_neither_named_nor_denied) {
  hidden::Request request;
  request.seed = 2998500626;
  request.effects = {hidden::HiddenEffect::kTimeDelay};
  request.torque_noise_share = 0.04;
  request.encoder_bits = 13;
  const hidden::Case made = hidden::make_case(request);
  const Explanation result = explain_case(made, quick());
  EXPECT_EQ(result.verdict, Verdict::kNotExcited) << result.words;
  EXPECT_THAT(result.found, IsEmpty());
  ASSERT_TRUE(result.suspected);
  EXPECT_EQ(result.suspected->what,
            (EffectAt{EffectKind::kTimeDelay, made.truth.effects[0].joint}));
  EXPECT_LT(result.suspected->p_value, 0.05);
  const auto json = to_json(result, {});
  EXPECT_EQ(json["suspected"]["effect"], "time_delay");
  EXPECT_EQ(json["suspected"]["joint"], made.truth.effects[0].joint + 1);
}

TEST(Explain, GIVEN_an_effect_outside_of_the_list_THEN_it_is_unknown_and_nothing_is_found) {
  for (const auto outside : test::every_nth(hidden::all_outside_effects(), 4)) {
    hidden::Request request;
    request.seed = 2;
    request.outside = outside;
    const Explanation result = explain_case(hidden::make_case(request), quick());
    const bool external = outside == hidden::OutsideEffect::kTransientContact;
    EXPECT_EQ(result.verdict,
              external ? Verdict::kUnknownExternal : Verdict::kUnknownStateDependent)
        << hidden::name(outside) << ": " << result.words;
    EXPECT_THAT(result.found, IsEmpty()) << hidden::name(outside);
  }
}

// Whatever is named is what is hidden, or stands in a class with it.
void expect_nothing_wrong(const Explanation& told, const std::vector<EffectAt>& truth) {
  const auto holds_truth = [&](const std::vector<EffectAt>& same) {
    return std::any_of(same.begin(), same.end(),
                       [&](const EffectAt& one) { return holds(truth, one); });
  };
  const std::string hidden = truth.empty() ? std::string("nothing")
                                           : std::string(truth[0].name()) + " on joint " +
                                                 std::to_string(truth[0].joint + 1);
  for (const auto& same : told.ambiguous) {
    EXPECT_TRUE(holds_truth(same)) << told.words << " Hidden: " << hidden;
  }
  for (const Finding& one : told.found) {
    EXPECT_TRUE(holds(truth, one.what) || holds_in_any(told.ambiguous, one.what)) << told.words;
  }
}

TEST(Explain, GIVEN_a_poor_motion_THEN_it_names_nothing_wrong) {
  hidden::Request request;
  request.seed = 2;
  request.effects = {hidden::HiddenEffect::kStribeckFriction};
  request.excitation = hidden::Excitation::kPoor;
  const hidden::Case made = hidden::make_case(request);
  const Explanation result = explain_case(made, quick());
  expect_nothing_wrong(result, {{EffectKind::kStribeckFriction, made.truth.effects[0].joint}});
  EXPECT_NE(result.verdict, Verdict::kUnknownExternal) << result.words;
}

TEST(Explain, GIVEN_an_encoder_that_is_stuck_THEN_it_says_so_in_numbers) {
  const hidden::Case made = case_of(5, {hidden::HiddenEffect::kViscousFriction});
  Log stuck = to_log(made.recording);
  stuck.q.col(0).setConstant(0.3);
  stuck.dq_derived[0] = false;
  const Explanation result = explain(to_robot(made.nominal), {stuck}, {}, quick());
  EXPECT_EQ(result.verdict, Verdict::kDataFault) << result.words;
  EXPECT_THAT(result.words, HasSubstr("the position of joint 1 never changes"));
  for (const JointErrors& joint : result.joints) {
    EXPECT_TRUE(std::isfinite(joint.rms_after)) << joint.joint;
    EXPECT_TRUE(std::isfinite(joint.noise_floor)) << joint.joint;
  }
}

// A single slow sine or one speed to and fro, which many effects explain.
TEST(Explain, GIVEN_a_poor_motion_that_shows_an_effect_THEN_what_it_says_it_could_be_holds_it) {
  struct Shown {
    std::uint64_t seed;
    hidden::HiddenEffect effect;
  };
  // The ripple of the second repeats over more than the joint's range.
  constexpr std::array kShown{Shown{4100098333, hidden::HiddenEffect::kCoulombFriction},
                              Shown{3183555967, hidden::HiddenEffect::kCoggingTorque}};
  for (const Shown& shown : test::every_nth(kShown, 2)) {
    hidden::Request request;
    request.seed = shown.seed;
    request.effects = {shown.effect};
    request.excitation = hidden::Excitation::kPoor;
    const hidden::Case made = hidden::make_case(request);
    const Explanation result = explain_case(made, quick());
    const EffectAt truth{info_named(hidden::name(shown.effect))->kind, made.truth.effects[0].joint};
    expect_nothing_wrong(result, {truth});
    if (result.verdict == Verdict::kAmbiguous) {
      EXPECT_THAT(result.advice, Contains(HasSubstr("--separate")));
    }
    request.effects.clear();
    const Explanation healthy = explain_case(hidden::make_case(request), quick());
    EXPECT_THAT(healthy.found, IsEmpty()) << healthy.words;
    EXPECT_THAT(healthy.ambiguous, IsEmpty()) << healthy.words;
  }
}

TEST(Explain, FindsTwoEffectsAtOnce) {
  const hidden::Case made = case_of(
      4, {hidden::HiddenEffect::kCoggingTorque, hidden::HiddenEffect::kPeriodicDisturbance});
  const Explanation result = explain_case(made, quick());
  ASSERT_THAT(result.found, SizeIs(2)) << result.words;
  for (const hidden::TrueEffect& truth : made.truth.effects) {
    const EffectAt what{info_named(hidden::name(truth.effect))->kind, truth.joint};
    EXPECT_TRUE(result.found[0].what == what || result.found[1].what == what) << what.name();
  }
}

TEST(Explain, ParametersComeWithIntervalsThatHoldTheTruth) {
  const hidden::Case made = case_of(5, {hidden::HiddenEffect::kJointStiffness});
  const Explanation result = explain_case(made, quick());
  ASSERT_THAT(result.found, SizeIs(1));
  int compared = 0;
  for (const hidden::TrueParameter& truth : made.truth.effects[0].parameters) {
    const Estimate* one = estimate_of(truth.name, result.found[0]);
    if (one == nullptr) continue;
    EXPECT_NEAR(one->value.value, truth.value, 0.1 * std::abs(truth.value)) << truth.name;
    EXPECT_EQ(one->value.unit, truth.unit);
    ASSERT_TRUE(one->ci95);
    EXPECT_LT((*one->ci95)[0], (*one->ci95)[1]);
    ++compared;
  }
  EXPECT_GE(compared, 1);
}

TEST(Explain, TheSameInputGivesTheSameBytesForAnyNumberOfThreads) {
  const hidden::Case made = case_of(6, {hidden::HiddenEffect::kBacklash});
  const ExplainNames names{{"log"}, {"holdout"}, "robot", ""};
  std::vector<std::string> texts;
  for (const int threads : {1, 2, 8}) {
    ExplainOptions options = quick();
    options.threads = threads;
    texts.push_back(to_json(explain_case(made, options), names).dump());
  }
  EXPECT_EQ(texts[0], texts[1]);
  EXPECT_EQ(texts[0], texts[2]);
}

TEST(Explain, WithoutHoldOutBlocksOfTimeAreHeldOut) {
  const hidden::Case made = case_of(7, {hidden::HiddenEffect::kViscousFriction});
  const Explanation result = explain(to_robot(made.nominal), {to_log(made.recording)}, {}, quick());
  EXPECT_FALSE(result.holdout_is_apart);
  ASSERT_THAT(result.found, SizeIs(1));
  EXPECT_EQ(result.found[0].what.name(), "viscous_friction");
}

TEST(Explain, RefusesARecordingOfAnotherRobot) {
  hidden::Request request;
  const hidden::Case made = hidden::make_case(request);
  RobotDescription one_joint = to_robot(made.nominal);
  one_joint.joints.pop_back();
  std::erase_if(one_joint.effects, [](const RobotEffect& effect) { return effect.joint > 0; });
  try {
    explain(one_joint, {to_log(made.recording)}, {}, quick());
    FAIL() << "a recording of two joints was taken for one";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 joints"));
  }
}

TEST(Explain, RefusesToKeepWhatTheRobotDoesNotHave) {
  const RobotDescription robot = to_robot(case_of(5, {}).nominal);
  for (const char* keep : {"9:saturation", "1:gaps", "1:time_unit"}) {
    EXPECT_THROW(static_cast<void>(treat_all({}, robot, {keep_fault_of(keep)})), InputError)
        << keep;
  }
  EXPECT_NO_THROW(static_cast<void>(
      treat_all({}, robot, {keep_fault_of("all:gaps"), keep_fault_of("1:stuck")})));
}

// A file has as many effects as a controller holds: what is found beyond has no place.
TEST(Explain, GIVEN_a_file_without_room_THEN_it_finds_nothing_more) {
  RobotDescription robot = test::serial_arm(1);
  robot.effects.clear();
  for (int order = 0; order < kEffectsPerJoint; ++order) {
    robot.effects.push_back(
        test::effect_of(EffectKind::kCoggingTorque, 0, {1e-3, 1e-3, 40.0 + order}));
  }
  const Log log = test::record(test::serial_arm(1), {.duration_s = 12});
  const Explanation told = explain(robot, {log}, {}, quick());
  EXPECT_THAT(told.found, IsEmpty());
  robot.effects.pop_back();
  EXPECT_LE(explain(robot, {log}, {}, quick()).found.size(), 1U);
}

TEST(Explain, RefusesTooShortARecording) {
  hidden::Request request;
  request.duration_s = 0.2;
  const hidden::Case made = hidden::make_case(request);
  EXPECT_THROW(explain(to_robot(made.nominal), {to_log(made.recording)}, {}, quick()), InputError);
}

// A joint that is held, and torque that is zero: nothing divides by them.
TEST(Explain, ConstantSignalsEndInAVerdict) {
  hidden::Request request;
  request.duration_s = 10;
  const hidden::Case made = hidden::make_case(request);
  Log log = to_log(made.recording);
  log.q.setConstant(0.3);
  log.dq.setZero();
  log.tau.setZero();
  const Explanation result = explain(to_robot(made.nominal), {log}, {}, quick());
  EXPECT_THAT(result.found, IsEmpty());
  for (const JointErrors& joint : result.joints) EXPECT_TRUE(std::isfinite(joint.rms_before));
}

// The evidence in numbers, so that a broken step shows: a page says what the JSON says.
TEST(Explain, ThePageHasTheNumbersOfTheJson) {
  const Explanation result =
      explain_case(case_of(5, {hidden::HiddenEffect::kCoggingTorque}), quick());
  const ExplainNames names{{"log"}, {"holdout"}, "robot", ""};
  const auto json = to_json(result, names);
  const auto page = report::to_json(page_of(result, names));
  EXPECT_THAT(page["verdict"]["words"].get<std::string>(),
              HasSubstr(json["verdict"].get<std::string>()));
  const std::string text = page.dump();
  for (const auto& joint : json["joints"]) {
    EXPECT_THAT(text, HasSubstr(joint["holdout_after"].dump()));
    EXPECT_THAT(text, HasSubstr(joint["noise_floor"].dump()));
    EXPECT_THAT(text, HasSubstr(joint["holdout_noise_floor"].dump()));
  }
  ASSERT_EQ(json["waterfall"].size(), result.found.size() + 1);
  // Each joint's picture has the steps of its own effects.
  for (const auto& error : json["waterfall"][0]["holdout"]) {
    EXPECT_THAT(text, HasSubstr(error.dump()));
  }
  for (std::size_t i = 1; i < json["waterfall"].size(); ++i) {
    const auto& step = json["waterfall"][i];
    const std::size_t joint = step["added"]["joint"].get<std::size_t>() - 1;
    EXPECT_THAT(text, HasSubstr(step["holdout"][joint].dump()));
  }
  for (const auto& [name, parameter] : json["found"][0]["parameters"].items()) {
    EXPECT_THAT(text, HasSubstr(parameter["value"].dump())) << name;
  }
  EXPECT_NE(report::render(page_of(result, names)).find("<html"), std::string::npos);
}

TEST(Report, ThePageHasEveryClass) {
  Explanation result = explain_case(case_of(5, {hidden::HiddenEffect::kViscousFriction}), quick());
  const auto text = [&] { return report::to_json(page_of(result, {})).dump(); };
  EXPECT_THAT(text(), Not(HasSubstr("cannot tell apart")));
  result.ambiguous = {{{EffectKind::kViscousFriction, 0}, {EffectKind::kTimeDelay, 1}},
                      {{EffectKind::kHysteresis, 1}, {EffectKind::kJointElasticity, 1}}};
  EXPECT_THAT(text(), HasSubstr(R"([2.0,"joint_elasticity",2.0])"));
  EXPECT_THAT(text(), HasSubstr(R"([1.0,"time_delay",2.0])"));
  EXPECT_THAT(text(), Not(HasSubstr(kOwnNumbers)));
  // One effect alone stands beside the model's own numbers.
  result.ambiguous = {{{EffectKind::kViscousFriction, 0}}};
  EXPECT_THAT(text(), HasSubstr(kOwnNumbers));
  EXPECT_THAT(text_of(result, {}), HasSubstr(kOwnNumbers));
}

}  // namespace
}  // namespace offnominal::desk
