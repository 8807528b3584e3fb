#include "identify/add.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "added_value.hpp"
#include "common/error.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "identify/add_report.hpp"
#include "support/seed.hpp"

namespace {

using Eigen::Vector2d;
using offnominal::EffectKind;
using offnominal::test::arm_description;
using offnominal::test::arm_motion;
using offnominal::test::ArmInstant;
using offnominal::test::ArmRecording;
using offnominal::test::effect_of;
using offnominal::test::HiddenTorque;
using offnominal::test::record_arm;
using offnominal::test::value_of;
using namespace offnominal::desk;
using namespace offnominal::desk;
using ::testing::Contains;
using ::testing::HasSubstr;

// Torque noise 0.2 % of 50 N m, 19-bit encoders.
const ArmRecording kUsual{.torque_noise = 0.1, .encoder_step = 2 * std::numbers::pi / (1 << 19)};

double sign(double v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

AddRequest request_for(std::vector<EffectKind> effects, std::size_t joint) {
  AddRequest request;
  request.effects = std::move(effects);
  request.joint = joint;
  request.source = "test";
  return request;
}

// The effect on the arm without effects, fitted to a recording that hides `hidden`.
AddResult fit_one(EffectKind kind, std::size_t joint, const HiddenTorque& hidden,
                  const ArmRecording& settings = kUsual) {
  return add(arm_description(), request_for({kind}, joint), {record_arm(settings, hidden)}, {});
}

TEST(Add, GivenHiddenViscousFrictionThenItsCoefficientIsFound) {
  const AddResult result = fit_one(EffectKind::kViscousFriction, 1, [](const ArmInstant& at) {
    return Vector2d(0, 0.8 * at.dq[1]);
  });
  EXPECT_TRUE(result.objections.empty());
  ASSERT_EQ(result.fit.parameters.size(), 1U);
  const FittedParameter& coefficient = result.fit.parameters[0];
  EXPECT_NEAR(coefficient.value, 0.8, 0.01);
  ASSERT_TRUE(coefficient.ci95.has_value());
  EXPECT_LT((*coefficient.ci95)[0], coefficient.value);
  EXPECT_LT((*coefficient.ci95)[1] - (*coefficient.ci95)[0], 0.05);
  EXPECT_TRUE(result.robot.effects[0].fitted);
  EXPECT_EQ(result.robot.effects[0].source, "test");
  EXPECT_TRUE(result.cross_validated);
  ASSERT_EQ(result.held_out.size(), 1U);
  EXPECT_LT(result.held_out[0].after_rms, 0.1 * result.held_out[0].before_rms);
}

TEST(Add, GivenCoulombFrictionThenLevelAndWidthAreFound) {
  const AddResult result = fit_one(EffectKind::kCoulombFriction, 0, [](const ArmInstant& at) {
    return Vector2d(2.5 * std::tanh(at.dq[0] / 0.05), 0);
  });
  EXPECT_NEAR(value_of(result, EffectKind::kCoulombFriction, "level"), 2.5, 0.03);
  EXPECT_NEAR(value_of(result, EffectKind::kCoulombFriction, "smoothing"), 0.05, 0.005);
}

// A sign as sharp as the velocity resolves: its width is told from nothing on one side only.
TEST(Add, GivenASharpSignThenItsWidthIsNeverBelowZero) {
  int with_interval = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    ArmRecording noisy = kUsual;
    noisy.seed = seed;
    noisy.torque_noise = 1;
    const AddResult result = fit_one(
        EffectKind::kCoulombFriction, 0,
        [](const ArmInstant& at) { return Vector2d(0.5 * sign(at.dq[0]), 0); }, noisy);
    const FittedParameter& width = result.fit.parameters.at(1);
    ASSERT_EQ(width.parameter, 1U);
    EXPECT_NE(width.ci95.has_value(), !width.why_no_interval.empty());
    if (!width.ci95) continue;
    ++with_interval;
    EXPECT_GE((*width.ci95)[0], 0);
  }
  std::cout << with_interval << " of 4 have an interval\n";
}

TEST(Add, GivenStribeckFrictionBesideCoulombThenBothAreFound) {
  const AddResult result =
      add(arm_description(),
          request_for({EffectKind::kCoulombFriction, EffectKind::kStribeckFriction}, 0),
          {record_arm(kUsual,
                      [](const ArmInstant& at) {
                        const double ratio = at.dq[0] / 0.2;
                        return Vector2d(
                            std::tanh(at.dq[0] / 0.01) * (2 + 1.5 * std::exp(-ratio * ratio)), 0);
                      })},
          {});
  EXPECT_NEAR(value_of(result, EffectKind::kStribeckFriction, "level"), 1.5, 0.1);
  EXPECT_NEAR(value_of(result, EffectKind::kStribeckFriction, "stribeck_velocity"), 0.2, 0.01);
  EXPECT_NEAR(value_of(result, EffectKind::kCoulombFriction, "level"), 2, 0.05);
}

TEST(Add, GivenCoggingThenItsOrderIsFound) {
  const AddResult result = fit_one(EffectKind::kCoggingTorque, 1, [](const ArmInstant& at) {
    return Vector2d(0, 0.6 * std::sin(18 * at.q[1]) - 0.3 * std::cos(18 * at.q[1]));
  });
  EXPECT_NEAR(value_of(result, EffectKind::kCoggingTorque, "order"), 18, 0.01);
  EXPECT_NEAR(value_of(result, EffectKind::kCoggingTorque, "sine"), 0.6, 0.02);
  EXPECT_NEAR(value_of(result, EffectKind::kCoggingTorque, "cosine"), -0.3, 0.02);
}

TEST(Add, GivenAPeriodicDisturbanceThenItsFrequencyIsFound) {
  const AddResult result = fit_one(EffectKind::kPeriodicDisturbance, 0, [](const ArmInstant& at) {
    return Vector2d(0.5 * std::sin(30 * at.t_s), 0);
  });
  EXPECT_NEAR(value_of(result, EffectKind::kPeriodicDisturbance, "frequency"), 30, 0.01);
  EXPECT_NEAR(value_of(result, EffectKind::kPeriodicDisturbance, "sine"), 0.5, 0.03);
}

TEST(Add, GivenARotorInertiaThenItIsFound) {
  const AddResult result = fit_one(EffectKind::kRotorInertia, 1, [](const ArmInstant& at) {
    return Vector2d(0, 0.3 * at.ddq[1]);
  });
  EXPECT_NEAR(value_of(result, EffectKind::kRotorInertia, "inertia"), 0.3, 0.01);
}

// The recorded arm carries 0.4 kg more at its tip; the model's tip is at the frame's origin + 1 m.
TEST(Add, GivenAPayloadThenItsMassIsFoundThroughBothJoints) {
  ArmRecording heavy = kUsual;
  heavy.arm.mass2_kg = 2.4;
  AddRequest request = request_for({EffectKind::kTipPayload}, 1);
  request.set = {{"x", 1.0}};
  const AddResult result = add(arm_description(), request, {record_arm(heavy)}, {});
  EXPECT_NEAR(value_of(result, EffectKind::kTipPayload, "mass"), 0.4, 0.01);
  EXPECT_EQ(result.held_out.size(), 2U);
  // Before is what the file has as it is, in every verb the same.
  for (const BeforeAfter& error : result.held_out) {
    const JointComparison& file = result.before.joints[error.joint];
    EXPECT_NEAR(error.before_rms, file.rms_error, 1e-3 * file.rms_error);
  }
}

TEST(Add, JudgesAMassByEveryJointThatCarriesIt) {
  const RobotDescription arm = arm_description();
  EXPECT_EQ(joints_asked(arm, request_for({EffectKind::kTipPayload}, 1)),
            (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(joints_asked(arm, request_for({EffectKind::kViscousFriction}, 1)),
            (std::vector<std::size_t>{1}));
}

TEST(Add, GivenAStiffSpringThenStiffnessAndRestPositionAreFound) {
  const AddResult result = fit_one(EffectKind::kJointStiffness, 1, [](const ArmInstant& at) {
    return Vector2d(0, 4 * (at.q[1] - 0.35));
  });
  EXPECT_NEAR(value_of(result, EffectKind::kJointStiffness, "stiffness"), 4, 0.05);
  EXPECT_NEAR(value_of(result, EffectKind::kJointStiffness, "rest_position"), 0.35, 0.01);
}

TEST(Add, EffectsMarkedFittedAreFittedAgainOthersAreNot) {
  const Log measured = record_arm(
      kUsual, [](const ArmInstant& at) { return Vector2d(0, 0.8 * at.dq[1] + sign(at.dq[1])); });
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kViscousFriction, 1, {2.0}, true),
                   effect_of(EffectKind::kTorqueOffset, 0, {0.7}, true)};
  const AddRequest request = request_for({EffectKind::kCoulombFriction}, 1);
  const AddResult again = add(robot, request, {measured}, {});
  EXPECT_NEAR(again.robot.effects[0].parameters[0], 0.8, 0.02);
  EXPECT_EQ(again.robot.effects[1].parameters[0], 0.7) << "another joint's effect is not touched";
  EXPECT_THAT(again.notes, Contains(HasSubstr("fitted again together with it: viscous_friction")));

  AddRequest keep = request;
  keep.keep = true;
  EXPECT_EQ(add(robot, keep, {measured}, {}).robot.effects[0].parameters[0], 2.0);
  robot.effects[0].fitted = false;
  EXPECT_EQ(add(robot, request, {measured}, {}).robot.effects[0].parameters[0], 2.0);
}

TEST(Add, WidthsOfOneJointHaveOneValue) {
  const Log measured = record_arm(kUsual, [](const ArmInstant& at) {
    const double s = std::tanh(at.dq[1] / 0.04);
    return Vector2d(0, 2 * s + 0.5 * at.dq[1] * s + 0.3 * s * s);
  });
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kCoulombFriction, 1, {2, 0.5}, true)};
  const AddRequest request = request_for({EffectKind::kFrictionAsymmetry}, 1);
  const AddResult tied = add(robot, request, {measured}, {});
  EXPECT_NEAR(tied.robot.effects[0].parameters[1], 0.04, 0.004);
  EXPECT_EQ(tied.robot.effects[0].parameters[1], tied.robot.effects[1].parameters[2]);
  robot.effects[0].fitted = false;
  robot.effects[0].parameters[1] = 0.05;
  const AddResult taken = add(robot, request, {measured}, {});
  EXPECT_EQ(taken.robot.effects[1].parameters[2], 0.05);
}

TEST(Add, GivenValuesAreNotFitted) {
  AddRequest request = request_for({EffectKind::kCoulombFriction}, 0);
  request.set = {{"coulomb_friction.smoothing", 0.02}};
  const AddResult result = add(
      arm_description(), request,
      {record_arm(kUsual, [](const ArmInstant& at) { return Vector2d(2 * sign(at.dq[0]), 0); })},
      {});
  EXPECT_EQ(value_of(result, EffectKind::kCoulombFriction, "smoothing"), 0.02);
  const auto json = to_json(result, request, {{"a"}, {}, "b", "c", ""});
  EXPECT_EQ(json.at("parameters").at("smoothing").at("fitted"), false);
  EXPECT_TRUE(json.at("parameters").at("smoothing").at("ci95").is_null());
  EXPECT_EQ(json.at("parameters").at("level").at("unit"), "N m");
}

TEST(Add, GivenTheWrongMassThenRefittingInertiaFindsBothAndNotRefittingBiases) {
  ArmRecording heavy = kUsual;
  heavy.arm.mass2_kg = 2.1;
  const Log measured =
      record_arm(heavy, [](const ArmInstant& at) { return Vector2d(0, 0.8 * at.dq[1]); });
  AddRequest request = request_for({EffectKind::kViscousFriction}, 1);
  request.inertia_deviation = 0.05;
  const AddResult result = add(arm_description(), request, {measured}, {});
  ASSERT_EQ(result.fit.links.size(), 2U);
  EXPECT_NEAR(result.fit.links[1].factor, 1.05, 0.002);
  EXPECT_NEAR(result.robot.joints[1].joint.mass_kg, 2.1, 0.005);
  EXPECT_NEAR(value_of(result, EffectKind::kViscousFriction, "coefficient"), 0.8, 0.01);
  EXPECT_THAT(result.robot.joints[1].source, HasSubstr("Mass and inertia times 1.0"));

  request.inertia_deviation.reset();
  const AddResult without = add(arm_description(), request, {measured}, {});
  EXPECT_TRUE(without.fit.links.empty());
  EXPECT_EQ(without.robot.joints[1].joint.mass_kg, 2.0);
  EXPECT_GT(without.held_out[0].after_rms, 3 * result.held_out[1].after_rms);
}

TEST(Add, GivenTwoEffectsThatAreOneThenItObjects) {
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kLinkMass, 1, {0.1}, true)};
  AddRequest request = request_for({EffectKind::kTipPayload}, 1);
  request.set = {{"x", 1.0}};  // the link's own centre of mass
  const AddResult result = add(robot, request, {record_arm(kUsual)}, {});
  EXPECT_THAT(result.objections,
              Contains(HasSubstr("cannot tell tip_payload from link_mass.mass of joint 2")));
  EXPECT_THAT(verdict_of(result, request), HasSubstr("Nothing was written"));
  EXPECT_TRUE(to_json(result, request, {{"a"}, {}, "b", "c", ""}).at("written").is_null());
}

TEST(Add, GivenAJointThatDoesNotMoveThenItObjects) {
  Log log = record_arm({});
  log.q.col(1).setConstant(0.2);
  const AddResult result =
      add(arm_description(), request_for({EffectKind::kViscousFriction}, 1), {log}, {});
  EXPECT_THAT(result.objections, Contains(HasSubstr("has no influence on the torque")));
}

TEST(Add, GivenANegativeRotorInertiaThenItObjects) {
  const AddResult result = fit_one(EffectKind::kRotorInertia, 1, [](const ArmInstant& at) {
    return Vector2d(0, -0.1 * at.ddq[1]);
  });
  EXPECT_THAT(result.objections,
              Contains(HasSubstr("rotor_inertia.inertia of joint 2 came out as -0.09")));
}

TEST(Add, OffsetLooksLikeTheLevelOfAnAsymmetryAndTheNotesSaySo) {
  const AddResult result =
      fit_one(EffectKind::kTorqueOffset, 1, [](const ArmInstant&) { return Vector2d(0, 1.3); });
  EXPECT_TRUE(result.objections.empty());
  EXPECT_NEAR(value_of(result, EffectKind::kTorqueOffset, "level"), 1.3, 0.02);
  EXPECT_THAT(result.notes, Contains(HasSubstr("friction_asymmetry.level")));
}

TEST(Add, GivenNoEffectInTheDataThenTheVerdictSaysThatTheErrorDoesNotFall) {
  const AddRequest request = request_for({EffectKind::kQuadraticFriction}, 1);
  const AddResult result = add(arm_description(), request, {record_arm(kUsual)}, {});
  EXPECT_LT(std::abs(value_of(result, EffectKind::kQuadraticFriction, "coefficient")), 0.01);
  EXPECT_NE(level_of(result, request), report::Level::kGood);
}

TEST(Add, GivenAHoldOutRecordingThenTheErrorIsJudgedOnIt) {
  const auto hidden = [](const ArmInstant& at) { return Vector2d(0, 0.8 * at.dq[1]); };
  ArmRecording other = kUsual;
  other.seed = 9;
  other.amplitude = 0.7;
  const Log holdout = record_arm(other, hidden);
  const AddResult result = add(arm_description(), request_for({EffectKind::kViscousFriction}, 1),
                               {record_arm(kUsual, hidden)}, {holdout});
  EXPECT_FALSE(result.cross_validated);
  ASSERT_EQ(result.held_out.size(), 2U);
  const Comparison after =
      compare(result.robot, measure(holdout, arm_description(), result.after.recordings[0].plan));
  EXPECT_EQ(result.held_out[1].after_percent, after.joints[1].relative_error_percent);
  EXPECT_LT(result.held_out[1].after_percent, 0.2 * result.held_out[1].before_percent);
}

TEST(Add, SameInputGivesTheSameBytes) {
  const auto once = [] {
    const AddRequest request =
        request_for({EffectKind::kCoulombFriction, EffectKind::kTorqueOffset}, 0);
    const AddResult result = add(
        arm_description(), request,
        {record_arm(kUsual,
                    [](const ArmInstant& at) { return Vector2d(2 * sign(at.dq[0]) + 0.4, 0); })},
        {});
    return to_json(result, request, {{"a"}, {}, "b", "c", ""}).dump();
  };
  EXPECT_EQ(once(), once());
}

// 95 % intervals of a friction coefficient under noise that is correlated over 0.1 s.
TEST(Add, IntervalsCoverTheTruthUnderCorrelatedNoise) {
  auto generator = offnominal::test::seeded_generator();
  std::normal_distribution<double> normal;
  constexpr int kRecordings = 100;
  int covered = 0;
  for (int i = 0; i < kRecordings; ++i) {
    double noise = 0;
    const auto hidden = [&](const ArmInstant& at) {
      noise = 0.9 * noise + normal(generator);
      return Vector2d(0, 0.8 * at.dq[1] + 0.2 * noise);
    };
    const Log log = record_arm({.duration_s = 30, .rate_hz = 100}, hidden);
    const AddResult result =
        add(arm_description(), request_for({EffectKind::kViscousFriction}, 1), {log}, {});
    const auto& ci95 = result.fit.parameters[0].ci95;
    ASSERT_TRUE(ci95.has_value());
    covered += (*ci95)[0] <= 0.8 && 0.8 <= (*ci95)[1];
  }
  std::cout << covered << " of " << kRecordings << " intervals hold the truth\n";
  EXPECT_GE(covered, 87);
  EXPECT_LE(covered, 100);
}

TEST(Add, RequestsThatMakeNoSenseAreRefused) {
  const Log measured = record_arm({.duration_s = 3});
  const auto refuse = [&](const AddRequest& request, const RobotDescription& robot) {
    try {
      add(robot, request, {measured}, {});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const RobotDescription arm = arm_description();
  EXPECT_THAT(refuse(request_for({EffectKind::kViscousFriction}, 2), arm),
              HasSubstr("found 3; allowed: 1 to 2, the joints of robot arm; to mend: count "
                        "from the base outwards: 1 is shoulder, 2 is elbow"));
  RobotDescription with = arm;
  with.effects = {effect_of(EffectKind::kViscousFriction, 1, {1})};
  EXPECT_THAT(refuse(request_for({EffectKind::kViscousFriction}, 1), with),
              HasSubstr("viscous_friction in the model already"));
  EXPECT_THAT(refuse(request_for({EffectKind::kTorqueOffset, EffectKind::kTorqueOffset}, 1), arm),
              HasSubstr("asked for twice"));
  AddRequest request = request_for({EffectKind::kCoulombFriction}, 0);
  request.set = {{"smothing", 1}};
  EXPECT_THAT(refuse(request, arm), HasSubstr("allowed: level, smoothing"));
  request.set = {{"smoothing", -1}};
  EXPECT_THAT(refuse(request, arm), HasSubstr("--set smoothing"));
  request.set = {{"smoothing", 0.1}, {"level", 1}};
  EXPECT_THAT(refuse(request, arm), HasSubstr("at least one left to fit"));
  for (int i = 0; i < 16; ++i) {
    with.effects.push_back(effect_of(EffectKind::kCoggingTorque, 0, {1, 0, 3}));
  }
  EXPECT_THAT(refuse(request_for({EffectKind::kTorqueOffset}, 1), with), HasSubstr("up to 16"));
}

TEST(Add, PageCanBeRendered) {
  const AddRequest request = request_for({EffectKind::kViscousFriction}, 1);
  const AddResult result = fit_one(EffectKind::kViscousFriction, 1, [](const ArmInstant& at) {
    return Vector2d(0, 0.8 * at.dq[1]);
  });
  const report::Page page =
      page_of(result, request, {{"arm.csv"}, {}, "arm.toml", "new.toml", "offnominal add"});
  EXPECT_THAT(report::render(page), HasSubstr("viscous_friction"));
}

// Two payloads that are known, in two recordings of one friction.
TEST(Add, GivenRecordingsWithKnownPayloadsThenTheyAreFittedTogetherAsOneRobot) {
  const HiddenTorque hidden = [](const ArmInstant& at) { return Vector2d(0, 0.8 * at.dq[1]); };
  ArmRecording loaded = kUsual;
  loaded.arm.mass2_kg += 0.7;
  loaded.amplitude = 0.8;
  std::vector<Log> logs{record_arm(kUsual, hidden), record_arm(loaded, hidden)};
  const AddRequest request = request_for({EffectKind::kViscousFriction}, 1);
  const AddResult unsaid = add(arm_description(), request, logs, {});
  logs[1].payload = Payload{0.7, arm_description().joints[1].joint.centre_of_mass_m};
  const AddResult result = add(arm_description(), request, logs, {});
  EXPECT_TRUE(result.objections.empty());
  EXPECT_NEAR(value_of(result, EffectKind::kViscousFriction, "coefficient"), 0.8, 0.01);
  EXPECT_LT(result.held_out[0].after_rms, 0.2 * unsaid.held_out[0].after_rms);
  ASSERT_EQ(result.recordings.size(), 2U);
  EXPECT_LT(result.recordings[1].joints[1].after_percent, 1);
  EXPECT_EQ(result.robot.effects.size(), 1U) << "a payload is a recording's, not the robot's";
}

}  // namespace
