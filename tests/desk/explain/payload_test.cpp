// What an arm carries: a mass anywhere on its last link.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "explain/doubts.hpp"
#include "explain/explain.hpp"
#include "explain/friction_family.hpp"
#include "identify/estimates.hpp"
#include "identify/regression.hpp"
#include "serial_arm.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr int kJoints = 5;

Explanation explained(const RobotDescription& file, const RobotDescription& real,
                      std::uint64_t seed) {
  ExplainOptions options;
  options.bootstrap_draws = 499;
  options.threads = 2;
  return explain(file, {test::record(real, {.duration_s = 15, .seed = seed})}, {}, options);
}

double number(const Finding& finding, const std::string& name) {
  for (const Estimate& one : finding.parameters) {
    if (one.value.name == name) return one.value.value;
  }
  ADD_FAILURE() << "no " << name;
  return 0;
}

// Its column is put together from those of the link's ten numbers.
TEST(Payload, HasTheTorqueOfAMassAtItsPlace) {
  const RobotDescription robot = test::serial_arm(kJoints);
  const std::vector<Log> logs{test::record(robot, {.duration_s = 5, .torque_noise_nm = 1e-6})};
  const FilterPlan plan = plan_filter(logs, robot);
  const Data data(make_workspaces(logs, robot, plan, Eigen::VectorXd::Zero(kJoints)), robot, {});
  const auto& all = all_candidates();
  const auto payload = std::find_if(all.begin(), all.end(), [](const auto& one) {
    return one->kind() == EffectKind::kTipPayload;
  });
  ASSERT_NE(payload, all.end());
  for (const ShapePoint& place : {ShapePoint{0.1, 0.02, -0.3}, ShapePoint{-0.2, 0.4, 0.05}}) {
    const Eigen::MatrixXd own =
        stacked_columns(data.layout, data.recordings, **payload, kJoints - 1, place);
    const Eigen::MatrixXd cached = columns_of(data, {payload->get(), kJoints - 1, place, {}, {}});
    ASSERT_GT(own.norm(), 1);
    EXPECT_LT((own - cached).norm(), 1e-9 * own.norm());
  }
}

// A gripper that holds something while its wrist stands: the other joints carry it.
TEST(Payload, OnALinkWhoseOwnJointStandsIsNamedByThoseThatCarryIt) {
  const RobotDescription file = test::serial_arm(kJoints);
  RobotDescription real = file;
  real.effects.push_back(
      test::effect_of(EffectKind::kTipPayload, kJoints - 1, {1.5, 0.02, -0.03, 0.06}));
  ExplainOptions options;
  options.bootstrap_draws = 499;
  options.threads = 2;
  const Log log = test::record(real, {.duration_s = 15, .seed = 5, .held = kJoints - 1});
  const Explanation told = explain(file, {log}, {}, options);
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  EXPECT_EQ(told.found[0].what, (EffectAt{EffectKind::kTipPayload, kJoints - 1}));
  EXPECT_NEAR(number(told.found[0], "mass"), 1.5, 0.15);
}

TEST(Payload, BesideTheAxisOfTheLastLinkIsNamedWithItsMassAndPlace) {
  const RobotDescription file = test::serial_arm(kJoints);
  RobotDescription real = file;
  real.effects.push_back(
      test::effect_of(EffectKind::kTipPayload, kJoints - 1, {0.8, 0.03, -0.09, 0.11}));
  const Explanation told = explained(file, real, 3);
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  const Finding& payload = told.found.front();
  EXPECT_EQ(payload.what, (EffectAt{EffectKind::kTipPayload, kJoints - 1})) << told.words;
  EXPECT_NEAR(number(payload, "mass"), 0.8, 0.04);
  EXPECT_NEAR(number(payload, "x"), 0.03, 0.02);
  EXPECT_NEAR(number(payload, "y"), -0.09, 0.02);
  EXPECT_NEAR(number(payload, "z"), 0.11, 0.02);
  for (const auto& same : told.ambiguous) {
    EXPECT_FALSE(same.size() > 2) << "a heavier last link at most comes as near: " << told.words;
  }
}

// Beside links that may be far off, a heavy mass near the joint and a light one far off do the
// same: how much it weighs is hardly known, that it is there is.
TEST(Payload, IsNoLessThereWhereOnlyItsMomentsAreKnown) {
  const RobotDescription file = test::serial_arm(kJoints);
  RobotDescription real = file;
  const ShapePoint place{0.03, -0.09, 0.11};
  real.effects.push_back(
      test::effect_of(EffectKind::kTipPayload, kJoints - 1, {0.4, place[0], place[1], place[2]}));
  const std::vector<Log> logs{test::record(real, {.duration_s = 15, .seed = 3})};
  const FilterPlan plan = plan_filter(logs, file);
  NuisanceOptions nuisance;
  nuisance.link_share = 0.6;
  nuisance.link_geometry = true;
  const Data data(make_workspaces(logs, file, plan, Eigen::VectorXd::Zero(kJoints)), file,
                  nuisance);
  Term payload = first_on_grid(data, EffectKind::kTipPayload, kJoints - 1);
  payload.shape = place;
  const Regression regression(data);
  const ModelFit fit = regression.fit({payload});
  const Estimates told = estimates_of(regression, file, {payload}, fit);
  const Estimate& mass = told.terms[0][0];
  ASSERT_EQ(mass.value.name, "mass");
  ASSERT_TRUE(mass.ci95);
  const double of_mass = mass.value.value / (((*mass.ci95)[1] - (*mass.ci95)[0]) / 2);
  EXPECT_GT(told.linear[0].from_nothing(), 2 * of_mass) << of_mass;
  EXPECT_GT(told.linear[0].from_nothing(), 1);
  // Mass and first moments, kg and kg m.
  const Eigen::VectorXd& numbers = told.linear[0].value;
  ASSERT_EQ(numbers.size(), 4);
  for (Index axis = 0; axis < 3; ++axis) {
    EXPECT_DOUBLE_EQ(numbers[1 + axis], numbers[0] * place[static_cast<std::size_t>(axis)]);
  }
}

// Its own joint does not feel it: the joints that carry it say whether it is there.
TEST(Payload, InTheAxisOfTheLastLinkIsSeenOnTheJointsThatCarryIt) {
  const RobotDescription file = test::serial_arm(kJoints);
  RobotDescription real = file;
  const auto& axis = file.joints.back().joint.axis;
  real.effects.push_back(test::effect_of(EffectKind::kTipPayload, kJoints - 1,
                                         {1.5, 0.15 * axis[0], 0.15 * axis[1], 0.15 * axis[2]}));
  const Explanation told = explained(file, real, 5);
  ASSERT_THAT(told.found, SizeIs(1)) << told.words;
  const Finding& payload = told.found.front();
  EXPECT_EQ(payload.what, (EffectAt{EffectKind::kTipPayload, kJoints - 1})) << told.words;
  EXPECT_NEAR(number(payload, "mass"), 1.5, 0.1);
  EXPECT_LT(payload.seen_on, kJoints - 1);
  EXPECT_GT(payload.takes_of_held_out(), 0.8);
  EXPECT_THAT(told.words, AllOf(HasSubstr("the error on held-out data of joint " +
                                          std::to_string(payload.seen_on + 1) + " falls by"),
                                Not(HasSubstr("falls by 0 %"))));
  EXPECT_THAT(doubts_of(told), IsEmpty());
}

// A payload at the centre of mass is nothing else: the simpler name is the right one.
TEST(Payload, AtTheCentreOfMassIsAHeavierLink) {
  const RobotDescription file = test::serial_arm(kJoints);
  RobotDescription real = file;
  real.effects.push_back(test::effect_of(EffectKind::kLinkMass, kJoints - 1, {0.8}));
  const Explanation told = explained(file, real, 4);
  ASSERT_THAT(told.found, Not(IsEmpty())) << told.words;
  EXPECT_EQ(told.found.front().what, (EffectAt{EffectKind::kLinkMass, kJoints - 1})) << told.words;
  EXPECT_THAT(told.ambiguous,
              Not(Contains(Contains(EffectAt{EffectKind::kTipPayload, kJoints - 1}))))
      << told.words;
}

}  // namespace
}  // namespace offnominal::desk
