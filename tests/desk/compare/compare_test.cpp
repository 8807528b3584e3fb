#include "compare/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/compare_report.hpp"
#include "recorded_arm.hpp"

namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::record_arm;
using namespace offnominal::desk;
using ::testing::HasSubstr;

TEST(Compare, GivenTheTrueModelThenTheErrorIsTheFiltersOnly) {
  const Comparison comparison =
      compare(arm_description(), measure(record_arm({}), arm_description()));
  ASSERT_EQ(comparison.joints.size(), 2U);
  for (const JointComparison& joint : comparison.joints) {
    EXPECT_LT(joint.relative_error_percent, 0.05);
    EXPECT_GT(joint.fit_percent, 99.9);
    EXPECT_EQ(joint.unit, "N m");
  }
  EXPECT_EQ(level_of(together({comparison})), report::Level::kGood);
}

TEST(Compare, GivenHiddenViscousFrictionThenTheErrorIsItsSizeAndFollowsTheVelocity) {
  const Log log = record_arm({}, [](const ArmInstant& at) { return Vector2d(0, 1.5 * at.dq[1]); });
  const Comparison comparison = compare(arm_description(), measure(log, arm_description()));
  const JointComparison& second = comparison.joints[1];
  const VectorXd dq = comparison.dq.col(1);
  EXPECT_NEAR(second.rms_error, 1.5 * std::sqrt(dq.squaredNorm() / static_cast<double>(dq.size())),
              2e-3);
  EXPECT_NEAR(second.relative_error_percent, 100 * second.rms_error / second.rms_torque, 1e-9);
  EXPECT_EQ(second.where.front().variable, "velocity");
  EXPECT_GT(second.where.front().share, 0.97);
  EXPECT_THAT(verdict_of(together({comparison})), HasSubstr("of the error follows the velocity"));
  EXPECT_LT(comparison.joints[0].relative_error_percent, 0.05);
}

TEST(Compare, WithWhatIsKeptOfTheRobotBeforeIsTheSameToTheBit) {
  const Measurement measured = measure(record_arm({.torque_noise = 0.1}), arm_description());
  RobotDescription rubs = arm_description();
  rubs.effects.push_back(
      offnominal::test::effect_of(offnominal::EffectKind::kViscousFriction, 1, {0.4}));
  RobotDescription heavy = rubs;
  heavy.joints[0].joint.mass_kg += 1;
  ModelTorqueMemory memory;
  for (const RobotDescription& robot : {arm_description(), rubs, heavy, rubs, arm_description()}) {
    EXPECT_EQ(compare(robot, measured, memory).model, compare(robot, measured).model);
  }
}

TEST(Compare, GivenNoTorqueAtAllThenThereIsNoPercentage) {
  Log log = record_arm({});
  log.tau.col(0).setZero();
  const Comparison comparison = compare(arm_description(), measure(log, arm_description()));
  EXPECT_TRUE(std::isnan(comparison.joints[0].relative_error_percent));
  EXPECT_TRUE(std::isnan(comparison.joints[0].fit_percent));
  EXPECT_THAT(verdict_of(together({comparison})), HasSubstr("0 throughout"));
  const auto json = to_json(together({comparison}), {{"log"}, "robot", ""});
  EXPECT_EQ(json.dump().find("nan"), std::string::npos);
  EXPECT_NE(json.dump().find("\"relative_error_percent\":null"), std::string::npos);
}

TEST(Compare, GivenAConstantTorqueThenTheFitDoesNotExist) {
  Log log = record_arm({});
  log.tau.col(0).setConstant(3);
  const Comparison comparison = compare(arm_description(), measure(log, arm_description()));
  EXPECT_TRUE(std::isnan(comparison.joints[0].fit_percent));
  EXPECT_FALSE(std::isnan(comparison.joints[0].relative_error_percent));
}

TEST(Compare, JsonHasTheFieldsOfTheCommand) {
  const Comparison comparison =
      compare(arm_description(), measure(record_arm({}), arm_description()));
  const auto json = to_json(together({comparison}), {{"arm.csv"}, "arm.toml", ""});
  ASSERT_EQ(json.at("joints").size(), 2U);
  const auto& joint = json.at("joints").at(1);
  EXPECT_EQ(joint.at("joint"), 2);
  EXPECT_EQ(joint.at("unit"), "N m");
  for (const char* name : {"rms_error", "rms_torque", "relative_error_percent", "fit_percent"}) {
    EXPECT_TRUE(joint.at(name).is_number()) << name;
  }
  EXPECT_EQ(json.at("filter").at("decimation"), 33);
  EXPECT_EQ(json.at("where").size(), 8U);
}

TEST(Compare, PageCanBeRendered) {
  const Comparison comparison =
      compare(arm_description(), measure(record_arm({}), arm_description()));
  const report::Page page =
      page_of(together({comparison}), {{"arm.csv"}, "arm.toml", "offnominal compare"});
  EXPECT_THAT(report::render(page), HasSubstr("arm.csv against arm.toml"));
  EXPECT_EQ(page.sections.size(), 3U);
}

TEST(ShareExplained, IsOneForAFunctionAndSmallForNoise) {
  const VectorXd x = VectorXd::LinSpaced(4000, -1, 1);
  EXPECT_GT(share_explained(x, x.array().cube()), 0.99);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  const VectorXd noise = VectorXd::NullaryExpr(4000, [&] { return normal(generator); });
  EXPECT_LT(share_explained(x, noise), 0.03);
  EXPECT_EQ(share_explained(VectorXd::Ones(4000), noise), 0);
  EXPECT_EQ(share_explained(x, VectorXd::Ones(4000)), 0);
}

}  // namespace
