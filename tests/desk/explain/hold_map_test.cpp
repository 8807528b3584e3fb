// Readings at rest: what `explain` finds in a simulated hold map, and in the recorded one of a
// motor.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/error.hpp"
#include "explain/add_found.hpp"
#include "explain/explain.hpp"
#include "held_motor.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "support/recordings.hpp"
#include "support/repetitions.hpp"
#include "support/robots.hpp"

namespace offnominal::desk {
namespace {

using ::testing::HasSubstr;

ExplainOptions quick_search() {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.threads = 2;
  return options;
}

double order_of(const Finding& finding) {
  for (const Estimate& one : finding.parameters) {
    if (one.value.name == "order") return one.value.value;
  }
  ADD_FAILURE() << finding.what.name() << " has no order";
  return 0;
}

std::vector<double> orders_of(const Explanation& explanation) {
  std::vector<double> orders;
  for (const Finding& finding : explanation.found) orders.push_back(order_of(finding));
  return orders;
}

TEST(HoldMap, ShowsTheOrderOfSlotsAndMagnetsFirst) {
  const Explanation e = explain(test::rotor(), {test::hold_map_of({})}, {}, quick_search());
  EXPECT_EQ(e.verdict, Verdict::kFound) << e.words;
  ASSERT_GE(e.found.size(), 3U);
  EXPECT_NEAR(order_of(e.found[0]), 72, 0.05);
  // Uneven teeth give multiples of the magnets' number, uneven magnets of the slots'.
  for (const double order : orders_of(e)) {
    const double of_either =
        std::min(std::abs(std::remainder(order, 18)), std::abs(std::remainder(order, 24)));
    EXPECT_LT(of_either, 0.3) << order;
  }
  const JointErrors& joint = e.joints[0];
  EXPECT_LT(joint.holdout_after, 0.15 * joint.holdout_before);
  ASSERT_EQ(e.hold_friction.size(), 1U);
  EXPECT_NEAR(e.hold_friction[0].level, 0.002, 0.0003);
}

TEST(HoldMap, WithoutCoggingNothingIsFound) {
  for (int seed = 1; seed <= test::repetitions(3); ++seed) {
    const test::HeldMotor smooth{.seed = static_cast<std::uint64_t>(seed), .cogging_nm = 0};
    const Explanation e = explain(test::rotor(), {test::hold_map_of(smooth)}, {}, quick_search());
    EXPECT_TRUE(e.found.empty()) << e.words;
    EXPECT_EQ(e.verdict, Verdict::kExplained) << e.words;
  }
}

TEST(HoldMap, OrdersGoIntoTheRobotFileAndAreNotFoundAgain) {
  const Log log = test::hold_map_of({});
  const AddedFindings added = add_found(test::rotor(), {log}, {}, quick_search(), {});
  ASSERT_THAT(added.objections, ::testing::IsEmpty());
  const RobotDescription& better = added.explanation.improved;
  ASSERT_EQ(better.effects.size(), added.explanation.found.size());
  for (const RobotEffect& effect : better.effects) {
    EXPECT_EQ(effect.kind, EffectKind::kCoggingTorque);
  }
  EXPECT_LT(added.gains[0].joints[0].after_rms, 0.3 * added.gains[0].joints[0].before_rms);
  for (const Finding& again : explain(better, {log}, {}, quick_search()).found) {
    EXPECT_GT(std::abs(order_of(again) - 72), 0.5);
  }
}

TEST(HoldMap, IsRefusedWhereTheModelNeedsTimeOrAPath) {
  for (const EffectKind kind : {EffectKind::kPeriodicDisturbance, EffectKind::kHysteresis,
                                EffectKind::kTimeDelay, EffectKind::kCoulombFriction}) {
    RobotDescription robot = test::rotor();
    robot.effects.push_back({{kind, 0, {0.001, 0.05, 1}}});
    const auto search = [&] { explain(robot, {test::hold_map_of({})}, {}, quick_search()); };
    if (kind == EffectKind::kCoulombFriction) {
      EXPECT_NO_THROW(search());
    } else {
      EXPECT_THROW(search(), InputError) << info_of(kind)->name;
    }
  }
}

TEST(HoldMap, IsNotMixedWithARecordingInTime) {
  Log moving = test::hold_map_of({});
  moving.at_rest = false;
  EXPECT_THROW(explain(test::rotor(), {test::hold_map_of({}), moving}, {}, quick_search()),
               InputError);
}

// The hold map of a T-Motor MN4004-KV300, robots/mn4004.toml. Published: 0.145 A, 0.048 A without
// order 72, 0.0195 A without all.
class HoldMapOfMn4004 : public ::testing::Test {
 protected:
  static constexpr double kNmPerA = 0.0318;

  void SetUp() override {
    const auto file = test::recordings_dir() / "laas_cogging/stopped_data.txt";
    if (!std::filesystem::exists(file)) {
      GTEST_SKIP() << "no recording at " << file << "; OFFNOMINAL_DATA names its folder";
    }
    robot_ = read_robot_file(test::kRobots / "mn4004.toml");
    log_ = read_log_or_hold_map(file, robot_, {});
  }

  RobotDescription robot_;
  Log log_;
};

// Minutes under the sanitizers, which watch the same lines on the smaller map above.
#ifndef OFFNOMINAL_SANITIZE
TEST_F(HoldMapOfMn4004, HasOrder72FirstThenItsFurtherOrders) {
  const Explanation e = explain(robot_, {log_}, {}, quick_search());
  EXPECT_EQ(e.verdict, Verdict::kFound) << e.words;
  EXPECT_NEAR(
      std::sqrt(log_.tau.squaredNorm() / static_cast<double>(log_.sample_count())) / kNmPerA, 0.145,
      0.001);
  ASSERT_GE(e.found.size(), 6U);
  EXPECT_NEAR(order_of(e.found[0]), 72, 0.05);
  const std::vector<double> orders = orders_of(e);
  for (const double published : {18, 12, 24, 36}) {
    EXPECT_THAT(orders, ::testing::Contains(::testing::DoubleNear(published, 0.05)));
  }
  EXPECT_LE(e.joints[0].holdout_after / kNmPerA, 0.020);
  EXPECT_NEAR(e.waterfall[1][0] / kNmPerA, 0.048, 0.004);  // with order 72 alone
  EXPECT_NEAR(e.hold_friction[0].level / kNmPerA, 0.053, 0.003);
}
#endif

TEST_F(HoldMapOfMn4004, IsRefusedWhereTimeIsNeeded) {
  const auto file = test::recordings_dir() / "laas_cogging/stopped_data.txt";
  try {
    read_log(file, robot_);
    FAIL() << "read as a recording in time";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("hold map"));
  }
}

}  // namespace
}  // namespace offnominal::desk
