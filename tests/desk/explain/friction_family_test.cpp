// Friction of a drive is a family: what is named is what its simpler members do not explain.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "serial_arm.hpp"
#include "support/repetitions.hpp"

namespace offnominal::desk {
namespace {

ExplainOptions family_options() {
  ExplainOptions options;
  options.bootstrap_draws = 399;
  options.threads = 2;
  return options;
}

RobotDescription without_friction(RobotDescription robot) {
  robot.effects.clear();
  return robot;
}

bool is_found(const Explanation& e, EffectKind kind, Eigen::Index joint) {
  return std::any_of(e.found.begin(), e.found.end(), [&](const Finding& one) {
    return one.what == EffectAt{kind, joint};
  });
}

class CleanFriction : public ::testing::TestWithParam<std::size_t> {};

// Coulomb and viscous friction on every joint, in a file that has none: no phantom beside them.
TEST_P(CleanFriction, IsCoulombAndViscousFrictionAndNothingElse) {
  const RobotDescription real = test::serial_arm(GetParam());
  const RobotDescription robot = without_friction(real);
  for (const std::uint64_t seed : test::every_nth(std::vector<std::uint64_t>{1, 2}, 2)) {
    const Log log = test::record(real, {.duration_s = 12, .seed = seed});
    const Explanation told = explain(robot, {log}, {}, family_options());
    for (const Finding& one : told.found) {
      const bool simple = one.what.kind == EffectKind::kCoulombFriction ||
                          one.what.kind == EffectKind::kViscousFriction;
      EXPECT_TRUE(simple) << one.what.name() << " on joint " << one.what.joint + 1 << ", seed "
                          << seed;
    }
    for (Eigen::Index joint = 0; joint < robot.joint_count(); ++joint) {
      EXPECT_TRUE(is_found(told, EffectKind::kCoulombFriction, joint))
          << joint << ": " << told.words;
      EXPECT_TRUE(is_found(told, EffectKind::kViscousFriction, joint))
          << joint << ": " << told.words;
    }
    EXPECT_THAT(told.ambiguous, ::testing::IsEmpty()) << told.words;
  }
}

INSTANTIATE_TEST_SUITE_P(OneAndThree, CleanFriction, ::testing::Values(1, 3),
                         [](const auto& joints) { return std::to_string(joints.param); });

// A description with numbers that nobody measured: the slope of what is there would be below zero,
// which physics does not let be, and the level is told all the same.
TEST(InventedFriction, IsHeldAtNothingAndTheRestIsTold) {
  const RobotDescription made = test::serial_arm(2);
  RobotDescription real = without_friction(made);
  RobotDescription robot = real;
  const auto put = [](RobotDescription& on, double slope, double level) {
    on.effects.push_back(test::effect_of(EffectKind::kViscousFriction, 1, {slope}, true));
    on.effects.push_back(test::effect_of(EffectKind::kCoulombFriction, 1, {level, 0.01}, true));
  };
  put(real, -0.15, 1);
  put(robot, 0.4, 0.2);
  const Log log = test::record(real, {.duration_s = 12, .seed = 7});
  const Explanation told = explain(robot, {log}, {}, family_options());
  std::map<std::string, double> came;
  for (const Shift& one : told.shifts) came[one.name] = one.came;
  ASSERT_THAT(came, testing::SizeIs(2)) << told.words;
  EXPECT_NEAR(came.at("viscous_friction.coefficient of joint 2"), 0, 1e-6);
  EXPECT_NEAR(came.at("coulomb_friction.level of joint 2"), 0.88, 0.1);
}

// What a joint may do says nothing of what it did.
TEST(Excitation, TheLimitsOfTheJointsChangeNoVerdict) {
  const RobotDescription real = test::serial_arm(2);
  RobotDescription robot = without_friction(real);
  const Log log = test::record(real, {.duration_s = 12, .seed = 3});
  const ExplainNames as{{"log"}, {}, "robot", ""};
  const nlohmann::ordered_json free = to_json(explain(robot, {log}, {}, family_options()), as);
  for (RobotJoint& one : robot.joints) {
    one.joint.min_position = -3;
    one.joint.max_position = 3;
    one.joint.max_velocity = 8;
  }
  const nlohmann::ordered_json limited = to_json(explain(robot, {log}, {}, family_options()), as);
  EXPECT_EQ(free.dump(), limited.dump());
}

TEST(PoorCad, IsNotWhatOneLinkOfAnotherMassIs) {
  const RobotDescription robot = test::serial_arm(2);
  RobotDescription real = robot;
  real.effects.push_back(test::effect_of(EffectKind::kLinkMass, 1, {0.9}, true));
  const Log log = test::record(real, {.duration_s = 12, .seed = 5});
  const Explanation told = explain(robot, {log}, {}, family_options());
  EXPECT_FALSE(told.link_share_judged);
  EXPECT_EQ(told.verdict, Verdict::kParameterShift) << told.words;
}

}  // namespace
}  // namespace offnominal::desk
