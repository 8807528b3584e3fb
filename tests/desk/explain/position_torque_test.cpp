#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>

#include "explain/add_found.hpp"
#include "explain/any_shape.hpp"
#include "explain/verdict.hpp"
#include "hidden_case.hpp"
#include "identify/add.hpp"
#include "serial_arm.hpp"

// A curve over the position can stand for a spring, a weight or a constant torque: it has a name
// only where none of them is what the recordings show. What hides it is a gas spring of the
// simulator, which is no B-spline.

namespace offnominal::desk {
namespace {

namespace hidden = sim::hidden;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

ExplainOptions quick() {
  ExplainOptions options;
  options.bootstrap_draws = 199;
  options.replays = 0;
  options.threads = 2;
  return options;
}

Explanation explain_case(const hidden::Case& made) {
  return explain(test::to_robot(made.nominal), {test::to_log(made.recording)},
                 {test::to_log(made.holdout)}, quick());
}

bool names_a_curve(const Explanation& told) {
  return std::any_of(told.found.begin(), told.found.end(), [](const Finding& one) {
    return one.what.kind == EffectKind::kPositionTorque;
  });
}

TEST(PositionTorque, IsFoundAloneWhereAGasSpringIsHidden) {
  const hidden::Case made = test::case_of(5, {hidden::HiddenEffect::kPositionTorque});
  const Explanation told = explain_case(made);
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  EXPECT_EQ(told.found[0].what,
            (EffectAt{EffectKind::kPositionTorque, made.truth.effects[0].joint}));
  EXPECT_THAT(told.ambiguous, IsEmpty());
  EXPECT_TRUE(is_to_write(told.verdict)) << told.words;
  EXPECT_EQ(told.improved.effects.back().kind, EffectKind::kPositionTorque);
}

TEST(PositionTorque, LeavesEverySimplerEffectItsName) {
  using enum hidden::HiddenEffect;
  for (const auto effect : {kJointStiffness, kLinkMass, kTorqueOffset, kCoggingTorque}) {
    const hidden::Case made = test::case_of(7, {effect});
    const Explanation told = explain_case(made);
    EXPECT_FALSE(names_a_curve(told)) << hidden::name(effect) << ": " << told.words;
    ASSERT_THAT(told.found, Not(IsEmpty())) << hidden::name(effect) << ": " << told.words;
    EXPECT_EQ(told.found[0].what.name(), hidden::name(effect));
  }
}

// Ripples are searched from two periods over the range on, and a curve follows one period as well.
TEST(PositionTorque, IsNotNamedForARippleOfLittleMoreThanAPeriod) {
  const RobotDescription robot = test::serial_arm(2);
  const Log plain = test::record(robot, {.duration_s = 25});
  const double range = plain.q.col(1).maxCoeff() - plain.q.col(1).minCoeff();
  for (const double periods : {1.2, 1.6}) {
    const double order = periods * 2 * std::numbers::pi / range;
    RobotDescription real = robot;
    real.effects.push_back(
        test::effect_of(EffectKind::kCoggingTorque, 1, {1.5, -0.8, order}, true));
    const Explanation told = explain(robot, {test::record(real, {.duration_s = 25})}, {}, quick());
    EXPECT_FALSE(names_a_curve(told)) << periods << ": " << told.words;
    ASSERT_THAT(told.found, SizeIs(1)) << periods << ": " << told.words;
    EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kCoggingTorque, 1}));
  }
}

TEST(PositionTorque, IsAddedWithTheRangeOfTheRecordingAndLowersTheHeldOutError) {
  const hidden::Case made = test::case_of(5, {hidden::HiddenEffect::kPositionTorque});
  const auto joint = static_cast<std::size_t>(made.truth.effects[0].joint);
  AddRequest request;
  request.effects = {EffectKind::kPositionTorque};
  request.joint = joint;
  const Log holdout = test::to_log(made.holdout);
  const Log log = test::to_log(made.recording);
  const AddResult added = add(test::to_robot(made.nominal), request, {log}, {holdout});
  ASSERT_THAT(added.added, SizeIs(1));
  const RobotEffect& curve = added.robot.effects[added.added[0]];
  const auto q = log.q.col(static_cast<Eigen::Index>(joint));
  EXPECT_NEAR(curve.parameters[0], q.minCoeff(), 0.01);
  EXPECT_NEAR(curve.parameters[0] + curve.parameters[1], q.maxCoeff(), 0.01);
  for (const BeforeAfter& error : added.held_out) {
    if (error.joint != joint) continue;
    EXPECT_GT(error.fall(), 0.6) << error.before_percent;
  }
  EXPECT_THAT(added.doubts, IsEmpty());
  EXPECT_THAT(added.objections, IsEmpty());
}

TEST(PositionTorque, IsOfferedWhereAnEndStopIsNoSmoothCurve) {
  Explanation told;
  told.robot_file = "arm.toml";
  told.joints.resize(2);
  for (Eigen::Index joint = 0; joint < 2; ++joint) {
    JointErrors& errors = told.joints[static_cast<std::size_t>(joint)];
    errors.joint = joint;
    errors.unit = "N m";
    errors.rms_torque = 10;
    errors.rms_before = errors.rms_after = joint == 1 ? 2 : 0.1;
    errors.noise_floor = 0.1;
  }
  told.excitation.resize(2);
  for (Excitation& one : told.excitation) one.moves = one.sufficient = true;
  told.where = {{1, "position", 0.7}};
  judge_whole(told);
  EXPECT_EQ(told.verdict, Verdict::kUnknownStateDependent);
  EXPECT_THAT(told.advice,
              Contains(HasSubstr("offnominal add position_torque --joint 2 --robot arm.toml")));
  EXPECT_THAT(told.advice, Not(Contains(HasSubstr("--joint 1"))));
}

TEST(PositionTorque, IsTheOnlyCurveOfAnyShapeAndOverThePosition) {
  ASSERT_NE(any_shape_over("position"), nullptr);
  EXPECT_STREQ(any_shape_over("position")->name, "position_torque");
  EXPECT_EQ(any_shape_over("velocity"), nullptr);
  EXPECT_EQ(any_shape_over(""), nullptr);
}

}  // namespace
}  // namespace offnominal::desk
