// A name needs a size that the recordings tell from nothing.
#include "explain/sizes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "explain/friction_family.hpp"
#include "explain/treatment.hpp"
#include "identify/improved_robot.hpp"
#include "identify/stretches.hpp"
#include "identify/workspace.hpp"
#include "serial_arm.hpp"

namespace offnominal::desk {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

TEST(LinearPart, IsAsFarFromNothingAsItsRegionIsNarrow) {
  LinearPart part{Vector2d(2, 0), Vector2d(1, 4).asDiagonal().toDenseMatrix()};
  EXPECT_NEAR(part.from_nothing(), 2, 1e-12);
  part.value = Vector2d(0, 2);
  EXPECT_NEAR(part.from_nothing(), 1, 1e-12);
}

// Of a spring whose stiffness is not told from nothing, and its torque at 0 clearly is: as far from
// an offset as its stiffness is, whatever the offset.
TEST(LinearPart, IsAsFarFromALineAsWhatTheLineDoesNotHold) {
  const LinearPart spring{Vector2d(0.5, 9), Eigen::Matrix2d::Identity()};
  EXPECT_GT(spring.from_nothing(), 9);
  EXPECT_NEAR(spring.from_line(Vector2d(0, 3)), 0.5, 1e-12);
  EXPECT_NEAR(spring.from_line(Vector2d(0, -0.1)), 0.5, 1e-12);
  EXPECT_EQ((LinearPart{Vector2d(2, 0), {}}.from_line(Vector2d(0, 1))),
            std::numeric_limits<double>::infinity());
}

TEST(LinearPart, OfTooFewSamplesIsNotJudged) {
  EXPECT_EQ((LinearPart{Vector2d(2, 0), {}}.from_nothing()),
            std::numeric_limits<double>::infinity());
}

// One number: 1.96 standard deviations; two together sqrt(5.9915), from tables of chi squared.
TEST(LinearPart, IsWidenedByAStandardDeviation) {
  LinearPart one{VectorXd::Constant(1, 2.0), MatrixXd::Constant(1, 1, 9.0)};
  one.widen(VectorXd::Constant(1, 1.0));
  EXPECT_NEAR(one.region(0, 0), 9 + 3.8416, 1e-3);
  LinearPart two{Vector2d(2, 0), Eigen::Matrix2d::Identity()};
  two.widen(Vector2d(1, 0));
  EXPECT_NEAR(two.region(0, 0), 1 + 5.9915, 2e-3);
  EXPECT_NEAR(two.region(1, 1), 1, 1e-12);
}

// One joint with Coulomb and viscous friction, and a file that has neither.
class UnsureSizes : public ::testing::Test {
 protected:
  UnsureSizes() {
    const std::vector<Log> logs{test::record(test::serial_arm(1), {.duration_s = 12, .seed = 5})};
    const FilterPlan plan = plan_filter(logs, robot_);
    data_ = std::make_unique<Data>(make_workspaces(logs, robot_, plan, VectorXd::Zero(1)), robot_,
                                   NuisanceOptions{});
    regression_ = std::make_unique<Regression>(*data_);
    hold_out_ = std::make_unique<HoldOut>(*regression_, nullptr);
    found_.baseline = regression_->fit({});
    found_.unsure.assign(1, 0);
    found_.held_out_before = hold_out_->residual({}, found_.baseline);
    for (const EffectKind kind : {EffectKind::kCoulombFriction, EffectKind::kViscousFriction}) {
      found_.accepted.push_back({first_on_grid(*data_, kind, 0), 0.001, 1});
    }
    order_and_hold_out(*regression_, *hold_out_, 1, found_);
  }

  static RobotDescription without_friction() {
    RobotDescription robot = test::serial_arm(1);
    robot.effects.clear();
    return robot;
  }

  bool leave_out(const std::vector<double>& from_nothing) {
    return leave_out_unsure({{}, from_nothing}, *regression_, *hold_out_, 1, found_);
  }

  RobotDescription robot_ = without_friction();
  std::unique_ptr<Data> data_;
  std::unique_ptr<Regression> regression_;
  std::unique_ptr<HoldOut> hold_out_;
  FoundModel found_;
};

TEST_F(UnsureSizes, WhatIsThereIsFarFromNothingAndWhatIsNotIsNear) {
  std::vector<Term> terms = found_.terms();
  terms.push_back(first_on_grid(*data_, EffectKind::kJointStiffness, 0));
  const auto sizes = estimates_of(*regression_, robot_, terms, regression_->fit(terms)).linear;
  ASSERT_EQ(sizes.size(), 3U);
  EXPECT_GT(sizes[0].from_nothing(), 3);
  EXPECT_GT(sizes[1].from_nothing(), 3);
  EXPECT_LT(sizes[2].from_nothing(), 1.5);
}

TEST_F(UnsureSizes, KeepTheirNamesWhereAllAreSure) {
  EXPECT_FALSE(leave_out({4, 0.6}));
  EXPECT_EQ(found_.accepted.size(), 2U);
  EXPECT_EQ(found_.unsure[0], 0);
}

TEST_F(UnsureSizes, LoseTheLeastSureNameFirstAndAlone) {
  const EffectKind surer = found_.accepted[0].term.effect->kind();
  EXPECT_TRUE(leave_out({0.4, 0.3}));
  ASSERT_EQ(found_.accepted.size(), 1U);
  EXPECT_EQ(found_.accepted[0].term.effect->kind(), surer);
  EXPECT_FALSE(found_.suspected);
  EXPECT_EQ(found_.unsure[0], 1) << "something shows there, all the same";
  EXPECT_EQ(found_.waterfall.size(), 2U) << "judged anew on what is held out";
}

TEST_F(UnsureSizes, AloneAreStillSuspected) {
  leave_out({4, 0.3});
  ASSERT_EQ(found_.accepted.size(), 1U);
  const EffectKind last = found_.accepted[0].term.effect->kind();
  EXPECT_TRUE(leave_out({0.3}));
  EXPECT_TRUE(found_.accepted.empty());
  ASSERT_TRUE(found_.suspected);
  EXPECT_EQ(found_.suspected->term.effect->kind(), last);
  EXPECT_GT(found_.suspected->share, 0.3);
  EXPECT_LE(found_.suspected->share, 1);
  EXPECT_FALSE(leave_out({})) << "and there is an end";
}

// One effect, fitted to a recording of a joint, and its sizes.
struct OfOneEffect {
  VectorXd coefficients;
  Sizes sizes;
};

OfOneEffect sizes_of_one(const RobotDescription& real, EffectKind kind) {
  const RobotDescription robot = test::serial_arm(1);
  const std::vector<Log> logs{test::record(real, {.duration_s = 12, .seed = 5})};
  const FilterPlan plan = plan_filter(logs, robot);
  const NuisanceOptions none;
  const Data data(make_workspaces(logs, robot, plan, VectorXd::Zero(1)), robot, none);
  const std::vector<Term> terms{first_on_grid(data, kind, 0)};
  const ModelFit fit = Regression(data).fit(terms);
  return {fit.coefficients[0],
          sizes_of(improved_robot(robot, robot, data, {none, {}, {}, ""},
                                  relinearise(robot, data, none, terms, fit)))};
}

// Of what pushes away from where it rests.
TEST(Sizes, OfWhatCannotBeAreNothing) {
  RobotDescription pushed = test::serial_arm(1);
  pushed.effects.push_back(test::effect_of(EffectKind::kJointStiffness, 0, {-2, 0}, true));
  const OfOneEffect one = sizes_of_one(pushed, EffectKind::kJointStiffness);
  ASSERT_LT(one.coefficients[0], 0);
  ASSERT_EQ(one.sizes.from_nothing.size(), 1U);
  EXPECT_EQ(one.sizes.from_nothing[0], 0);
}

// Of a loss of more than all that goes through a gear: no file takes it.
TEST(Sizes, OfWhatNoRobotFileTakesAreNothing) {
  const auto with_factor = [](double factor) {
    RobotDescription robot = test::serial_arm(1);
    robot.effects.push_back(
        test::effect_of(EffectKind::kLoadDependentFriction, 0, {factor, 0.01}, true));
    return sizes_of_one(robot, EffectKind::kLoadDependentFriction);
  };
  EXPECT_GT(with_factor(0.3).sizes.from_nothing[0], 1);
  const OfOneEffect beyond = with_factor(1.6);
  ASSERT_GT(beyond.coefficients[0], 1);
  EXPECT_EQ(beyond.sizes.from_nothing[0], 0);
}

// Of a ripple on a joint that has none.
TEST(Sizes, OfAWaveThatRepeatsWithNothingAreNothing) {
  const OfOneEffect one = sizes_of_one(test::serial_arm(1), EffectKind::kCoggingTorque);
  ASSERT_GT(one.coefficients.norm(), 0);
  ASSERT_EQ(one.sizes.from_nothing.size(), 1U);
  EXPECT_EQ(one.sizes.from_nothing[0], 0);
}

}  // namespace
}  // namespace offnominal::desk
