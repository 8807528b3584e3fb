// What `add` does not write, and what it says of numbers that it has no interval for.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "desk/compare/recorded_arm.hpp"
#include "identify/add.hpp"
#include "identify/add_report.hpp"

namespace {

using Eigen::Vector2d;
using offnominal::EffectKind;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::ArmRecording;
using offnominal::test::effect_of;
using offnominal::test::HiddenTorque;
using offnominal::test::record_arm;
using namespace offnominal::desk;
using namespace offnominal::desk;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const ArmRecording kUsualArm{.torque_noise = 0.1, .encoder_step = 2 * std::numbers::pi / (1 << 19)};
const AddNames kNames{{"a"}, {}, "b", "c", "", false};

AddRequest on_joint_2(EffectKind kind) {
  AddRequest request;
  request.effects = {kind};
  request.joint = 1;
  request.source = "test";
  return request;
}

AddResult fitted(const RobotDescription& robot, EffectKind kind, const HiddenTorque& hidden,
                 const ArmRecording& settings = kUsualArm) {
  return add(robot, on_joint_2(kind), {record_arm(settings, hidden)}, {});
}

HiddenTorque viscous(double coefficient) {
  return [coefficient](const ArmInstant& at) { return Vector2d(0, coefficient * at.dq[1]); };
}

TEST(AddRefuses, GIVEN_friction_that_gives_energy_THEN_it_says_what_that_usually_means) {
  const AddResult result = fitted(arm_description(), EffectKind::kViscousFriction, viscous(-10));
  EXPECT_THAT(result.objections,
              Contains(AllOf(HasSubstr("viscous_friction.coefficient of joint 2 came out as -"),
                             HasSubstr("0 or more is possible"), HasSubstr("sign of the torque"))));
  EXPECT_FALSE(result.may_be_written(true)) << "no force writes what physics forbids";
}

TEST(AddRefuses, GIVEN_a_wrong_sign_within_the_interval_THEN_it_says_that_the_end_is_active) {
  const AddResult result =
      fitted(arm_description(), EffectKind::kViscousFriction, viscous(-0.0005));
  ASSERT_LT(result.fit.parameters.at(0).value, 0);
  EXPECT_THAT(result.objections, Contains(AllOf(HasSubstr("fits as well: the recording does not"),
                                                Not(HasSubstr("sign of the torque")))));
}

TEST(AddRefuses, GIVEN_a_number_of_the_file_that_fits_best_below_zero_THEN_it_is_held_there) {
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kViscousFriction, 1, {0.3}, true)};
  const AddResult result = fitted(robot, EffectKind::kTorqueOffset, [](const ArmInstant& at) {
    return Vector2d(0, 1.3 - 0.0005 * at.dq[1]);
  });
  EXPECT_THAT(result.objections, IsEmpty());
  EXPECT_EQ(result.robot.effects[0].parameters[0], 0);
  EXPECT_THAT(result.notes,
              Contains(HasSubstr("viscous_friction.coefficient of joint 2 was held at 0")));
  EXPECT_NEAR(result.robot.effects[1].parameters[0], 1.3, 0.02);
}

// What is hidden gives energy: whatever takes its place in the model would, and none may.
TEST(AddRefuses, GIVEN_effects_that_all_together_give_energy_THEN_none_of_them_is_written) {
  for (const EffectKind kind : {EffectKind::kQuadraticFriction, EffectKind::kStribeckFriction,
                                EffectKind::kTemperatureDrift}) {
    SCOPED_TRACE(info_of(kind)->name);
    const AddResult result = fitted(arm_description(), kind, viscous(-10));
    EXPECT_THAT(result.objections,
                Contains(AllOf(HasSubstr("the friction of joint 2 all together would give energy"),
                               HasSubstr("sign of the torque"))));
    EXPECT_FALSE(result.may_be_written(true));
  }
}

TEST(AddRefuses, GIVEN_a_trace_of_friction_that_gives_energy_THEN_it_says_that_none_fits_as_well) {
  const AddResult result =
      fitted(arm_description(), EffectKind::kQuadraticFriction, viscous(-0.02));
  ASSERT_LT(result.fit.parameters.at(0).value, 0);
  EXPECT_THAT(result.objections, Contains(AllOf(HasSubstr("over the whole motion"),
                                                HasSubstr("none at all fits as well"))));
}

TEST(AddRefuses, GIVEN_a_mass_that_is_not_the_files_by_far_THEN_it_names_the_unit_of_the_torque) {
  for (const auto& [factor, refused] : {std::pair{3.0, false}, std::pair{30.0, true}}) {
    RobotDescription robot = arm_description();
    const double real_kg = robot.joints[1].joint.mass_kg;
    robot.joints[1].joint.mass_kg /= factor;
    const AddResult result = fitted(robot, EffectKind::kLinkMass, viscous(0));
    EXPECT_NEAR(result.fit.parameters.at(0).value, real_kg * (1 - 1 / factor), 0.2 * real_kg);
    if (!refused) {
      EXPECT_THAT(result.objections, IsEmpty());
      continue;
    }
    EXPECT_THAT(result.objections,
                Contains(AllOf(HasSubstr("link 2 would have "), HasSubstr("unit of the torque"))));
  }
}

// Friction that falls with speed, or that a cold joint has less of, is friction all the same.
TEST(AddRefuses, GIVEN_enough_friction_beside_it_THEN_an_effect_may_be_negative) {
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kCoulombFriction, 1, {3.0, 0.01}, true)};
  const auto hidden = [](double level) {
    return [level](const ArmInstant& at) {
      return Vector2d(0, std::tanh(at.dq[1] / 0.01) *
                             (3 + level * std::exp(-at.dq[1] * at.dq[1] / (0.4 * 0.4))));
    };
  };
  const AddResult enough = fitted(robot, EffectKind::kStribeckFriction, hidden(-1.5));
  EXPECT_THAT(enough.objections, IsEmpty());
  EXPECT_LT(enough.robot.effects.at(1).parameters[0], -1);
  const AddResult too_much = fitted(robot, EffectKind::kStribeckFriction, hidden(-6));
  EXPECT_THAT(too_much.objections, Contains(AllOf(HasSubstr("would give energy: from 0."),
                                                  HasSubstr(" rad/s it drives the joint"))));
}

// The same constant torque as a torque_offset where the joint moves: no energy is given.
TEST(AddRefuses, GIVEN_a_difference_between_the_directions_THEN_it_is_not_taken_for_friction) {
  const AddResult result =
      fitted(arm_description(), EffectKind::kFrictionAsymmetry, [](const ArmInstant& at) {
        const double sign = std::tanh(at.dq[1] / 0.01);
        return Vector2d(0, 1.3 * sign * sign + 0.5 * at.dq[1] * sign);
      });
  EXPECT_THAT(result.objections, IsEmpty());
}

TEST(AddRefuses, GIVEN_a_number_that_may_be_nothing_THEN_only_force_writes_it) {
  const AddRequest request = on_joint_2(EffectKind::kRotorInertia);
  const AddResult result = add(arm_description(), request, {record_arm(kUsualArm)}, {});
  EXPECT_THAT(result.doubts, Contains(HasSubstr("0 fits as well")));
  EXPECT_FALSE(result.may_be_written(false));
}

TEST(AddRefuses, GIVEN_an_error_that_does_not_fall_THEN_only_force_writes_it) {
  const AddRequest request = on_joint_2(EffectKind::kCoggingTorque);
  const AddResult result = add(arm_description(), request, {record_arm(kUsualArm)}, {});
  ASSERT_FALSE(result.held_out.at(0).fall() > 0) << "nothing is hidden in this recording";
  EXPECT_THAT(result.objections, IsEmpty());
  EXPECT_THAT(result.doubts, Contains(HasSubstr("the error of joint 2 does not fall")));
  EXPECT_FALSE(result.may_be_written(false));
  EXPECT_TRUE(result.may_be_written(true));
  EXPECT_THAT(verdict_of(result, request, false), HasSubstr("--force writes it all the same"));
  EXPECT_TRUE(to_json(result, request, kNames).at("written").is_null());
  AddNames forced = kNames;
  forced.force = true;
  EXPECT_EQ(to_json(result, request, forced).at("written"), "c");
}

TEST(AddSays, WhichJointWasFittedAgain) {
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kViscousFriction, 1, {2.0}, true),
                   effect_of(EffectKind::kCoulombFriction, 1, {0.5, 0.01}, true)};
  const AddResult result = fitted(robot, EffectKind::kTorqueOffset, [](const ArmInstant& at) {
    return Vector2d(0, 1.3 + 0.8 * at.dq[1] + 0.4 * std::tanh(at.dq[1] / 0.01));
  });
  const std::string text = text_of(result, on_joint_2(EffectKind::kTorqueOffset), kNames);
  EXPECT_THAT(text, HasSubstr("(fitted again, joint 2)"));
  EXPECT_THAT(text, Not(HasSubstr("not fitted (fitted again")));
  EXPECT_THAT(text, HasSubstr("together with it: viscous_friction on joint 2"));
}

// A spring that nobody knows keeps the error alike for seconds: the recording has few blocks.
TEST(AddSays, WhyThereIsNoInterval) {
  RobotDescription robot = arm_description();
  robot.effects = {effect_of(EffectKind::kViscousFriction, 1, {0.3}, true),
                   effect_of(EffectKind::kCoulombFriction, 1, {0.2, 0.01}, true)};
  ArmRecording brief = kUsualArm;
  brief.duration_s = 2;
  const AddRequest request = on_joint_2(EffectKind::kTorqueOffset);
  const AddResult result = fitted(
      robot, EffectKind::kTorqueOffset,
      [](const ArmInstant& at) {
        return Vector2d(
            0, 1.5 * (at.q[1] - 0.1) + 0.3 * at.dq[1] + 0.2 * std::tanh(at.dq[1] / 0.01) + 1);
      },
      brief);
  int without = 0;
  for (const FittedParameter& parameter : result.fit.parameters) {
    if (!parameter.fitted) continue;
    EXPECT_NE(parameter.ci95.has_value(), !parameter.why_no_interval.empty());
    without += parameter.ci95 ? 0 : 1;
  }
  ASSERT_GT(without, 0) << "too long a recording for this test";
  const std::string text = text_of(result, request, kNames);
  EXPECT_THAT(text, HasSubstr("independent stretches"));
  EXPECT_THAT(text, Not(HasSubstr("factor of 7")));
  const auto level = to_json(result, request, kNames).at("parameters").at("level");
  EXPECT_TRUE(level.at("ci95").is_null());
  EXPECT_THAT(level.at("why_no_ci95").get<std::string>(), HasSubstr("record for longer"));
}

TEST(AddSays, ThatAJointIsChosenAndNotMeasured) {
  RobotDescription robot = arm_description();
  AddRequest request = on_joint_2(EffectKind::kJointCoupling);
  request.set = {{"source_joint", 1.0}};
  const AddResult result =
      add(robot, request,
          {record_arm(kUsualArm, [](const ArmInstant& at) { return Vector2d(0, 0.8 * at.dq[0]); })},
          {});
  EXPECT_THAT(text_of(result, request, kNames), Not(HasSubstr("factor of 7")));
}

}  // namespace
