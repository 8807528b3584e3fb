// What a recording cannot tell apart, by the angle between what two numbers do to the torque.

#include "identify/indistinct.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "compare/inverse_model.hpp"
#include "desk/compare/recorded_arm.hpp"
#include "identify/add.hpp"
#include "identify/data.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// A regression of the arm with one viscous friction on joint 2, whose other columns are as given.
struct Made {
  std::unique_ptr<Data> data;
  std::unique_ptr<Regression> regression;
  std::vector<Term> terms;

  Made(const RobotDescription& robot, const NuisanceOptions& options) {
    const Log log = test::record_arm({});
    const FilterPlan plan = plan_filter({log}, robot);
    data = std::make_unique<Data>(make_workspaces({log}, robot, plan, VectorXd::Zero(2)), robot,
                                  options);
    regression = std::make_unique<Regression>(*data);
  }
  void add(EffectKind kind, Index joint) {
    for (const auto& effect : all_candidates()) {
      if (effect->kind() == kind) terms.push_back({effect.get(), joint, {}, {}, {}});
    }
  }
  // The column of the robot's number i, at this angle to what it was before.
  void turn(Index i, double degrees, const VectorXd& away) {
    VectorXd column = data->nuisance.columns.col(i);
    const double angle = degrees * std::numbers::pi / 180;
    VectorXd beside = away - column * (column.dot(away) / column.squaredNorm());
    beside *= column.norm() / beside.norm();
    data->nuisance.columns.col(i) = std::cos(angle) * column + std::sin(angle) * beside;
  }
  [[nodiscard]] std::vector<IndistinctNumber> first() const {
    return first_indistinct(*regression, terms, regression->fit(terms));
  }
};

// The skew has a prior of nothing: it is not there.
NuisanceOptions plain() {
  NuisanceOptions options;
  options.link_share = 0;
  options.sign_shapes = false;
  return options;
}

TEST(Indistinct,
     GIVEN_two_numbers_at_ten_degrees_THEN_they_are_told_apart_and_at_two_they_are_not) {
  RobotDescription robot = test::arm_description();
  robot.effects = {test::effect_of(EffectKind::kViscousFriction, 1, {0.3}, true)};
  for (const double degrees : {10.0, 170.0, 2.0, 178.0}) {
    Made made(robot, plain());
    made.add(EffectKind::kViscousFriction, 1);
    made.turn(0, degrees, made.data->torque);
    const auto found = made.first();
    EXPECT_EQ(found.empty(), degrees == 10 || degrees == 170) << degrees;
    if (found.empty()) continue;
    EXPECT_EQ(found[0].fixed.of, ModelNumber::Of::kTerm) << "the new one gives way";
    ASSERT_EQ(found[0].others.size(), 1U);
    EXPECT_EQ(found[0].others[0].of, ModelNumber::Of::kNuisance);
  }
}

TEST(Indistinct, GIVEN_a_prior_THEN_like_numbers_are_told_apart) {
  RobotDescription robot = test::arm_description();
  robot.effects = {test::effect_of(EffectKind::kViscousFriction, 1, {0.3}, true)};
  Made made(robot, plain());
  made.add(EffectKind::kViscousFriction, 1);
  ASSERT_FALSE(made.first().empty());
  made.data->nuisance.terms[0].prior = {0, 1e-9, -2e-9, 2e-9};
  EXPECT_TRUE(made.first().empty());
}

TEST(Indistinct, GIVEN_a_number_that_is_held_THEN_it_takes_no_place) {
  RobotDescription robot = test::arm_description();
  robot.effects = {test::effect_of(EffectKind::kViscousFriction, 1, {0.3}, true)};
  Made made(robot, plain());
  made.add(EffectKind::kViscousFriction, 1);
  made.terms[0].given = {0.0};
  EXPECT_TRUE(made.first().empty());
  EXPECT_NEAR(made.regression->fit(made.terms).coefficients[0][0], 0, 1e-9);
}

// The curve's columns add up to a constant, which the model has already.
TEST(EvidenceForATerm, GIVEN_a_curve_beside_a_constant_THEN_it_is_judged_by_what_it_says_beyond) {
  RobotDescription robot = test::arm_description();
  robot.effects = {test::effect_of(EffectKind::kTorqueOffset, 1, {0.3}, true)};
  Made made(robot, plain());
  made.add(EffectKind::kPositionTorque, 1);
  Term& curve = made.terms[0];
  curve.ranges = curve.effect->shapes(made.data->recordings, 1);
  for (const ShapeRange& range : curve.ranges) curve.shape.push_back(range.grid.front());
  const ModelFit fit = made.regression->fit({});
  const Judge judge(fit.remainder);
  const Eigen::MatrixXd columns = columns_of(*made.data, curve);
  EXPECT_FALSE(judge.evidence(columns).usable);
  const Evidence evidence = evidence_for(judge, *made.data, curve);
  EXPECT_TRUE(evidence.usable);
  EXPECT_EQ(evidence.coefficients.size(), columns.cols() - 1);
}

// A recording of the arm at that amplitude; on `still`, joint 2 stands.
Data shapes_of(double amplitude, bool still, const NuisanceOptions& options) {
  test::ArmRecording settings;
  settings.amplitude = amplitude;
  Log log = test::record_arm(settings);
  if (still) {
    log.q.col(1).setConstant(0.3);
    log.dq.col(1).setZero();
  }
  const RobotDescription robot = test::arm_description();
  const FilterPlan plan = plan_filter({log}, robot);
  return {make_workspaces({log}, robot, plan, VectorXd::Constant(2, 0.01)), robot, options};
}

TEST(SignShapes, OfAJointThatStandsAreAsManyAsOfOneThatMoves) {
  const Data moving = shapes_of(1, false, {});
  const Data still = shapes_of(1, true, {});
  EXPECT_EQ(still.nuisance.columns.cols(), moving.nuisance.columns.cols());
  EXPECT_TRUE(still.nuisance.columns.allFinite());
}

TEST(SignShapes, GivenTheRangesThenACoefficientMeansTheSameInAnyRecording) {
  NuisanceOptions options;
  const Data fitted = shapes_of(1, false, options);
  options.ranges_moved = ranges_moved(fitted.recordings);
  const Data held_out = shapes_of(0.5, false, options);
  ASSERT_EQ(held_out.nuisance.terms.size(), fitted.nuisance.terms.size());
  for (std::size_t i = 0; i < fitted.nuisance.terms.size(); ++i) {
    EXPECT_EQ(held_out.nuisance.terms[i].name, fitted.nuisance.terms[i].name);
  }
}

TEST(AppliesInAny, GivenAJointThatStandsInTheFirstRecordingThenItMayStillHaveFriction) {
  const Data still = shapes_of(1, true, {});
  const Data moving = shapes_of(1, false, {});
  std::vector<Workspace> both{still.recordings[0], moving.recordings[0]};
  both[0].top_speed[1] = 0;
  for (const auto& effect : all_candidates()) {
    if (effect->kind() != EffectKind::kViscousFriction) continue;
    EXPECT_FALSE(effect->applies(both[0], 1));
    EXPECT_TRUE(effect->applies_in_any(both, 1));
  }
}

TEST(JointsAsked, OfAMotorAreThoseThatItMoves) {
  RobotDescription robot = test::arm_description();
  robot.transmission.emplace();
  robot.transmission->matrix = {{10, 10}, {0, 10}};
  AddRequest request;
  request.effects = {EffectKind::kViscousFriction};
  EXPECT_EQ(joints_asked(robot, request), (std::vector<std::size_t>{0}));
  request.of_motor = true;
  EXPECT_EQ(joints_asked(robot, request), (std::vector<std::size_t>{0, 1}));
  request.joint = 1;
  EXPECT_EQ(joints_asked(robot, request), (std::vector<std::size_t>{1}));
}

// What a motor of both joints has is no joint's own, and acts on both all the same.
TEST(EffectOfAMotor, IsOfAJointWhereItMovesThatAlone) {
  RobotDescription robot = test::arm_description();
  robot.transmission.emplace();
  robot.transmission->matrix = {{10, 10}, {0, 10}};
  RobotEffect friction = test::effect_of(EffectKind::kViscousFriction, 0, {0.3}, true);
  EXPECT_FALSE(acts_on_joint(robot, friction, 1));
  friction.of_motor = true;
  EXPECT_TRUE(acts_on_joint(robot, friction, 1));
  EXPECT_FALSE(is_of_joint(robot, friction, 0));
  friction.joint = 1;
  EXPECT_FALSE(acts_on_joint(robot, friction, 0));
  EXPECT_TRUE(is_of_joint(robot, friction, 1));
}

TEST(Indistinct, GIVEN_a_joint_that_stands_THEN_the_recording_does_not_excite_the_number) {
  Made made(test::arm_description(), plain());
  for (Workspace& at : made.data->recordings) at.motion.dq.col(1).setZero();
  made.add(EffectKind::kViscousFriction, 1);
  const auto found = made.first();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].others.empty());
}

}  // namespace
}  // namespace offnominal::desk
