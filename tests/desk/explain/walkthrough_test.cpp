// docs/find-a-missing-effect.md, as a user follows it with the paper's arm: a motion that shows
// enough, a recording of it, and the robot file with all that was found.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "desk/support/effect_parameter.hpp"
#include "desk/support/run_command.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

namespace {

using offnominal::EffectKind;
using offnominal::desk::read_robot_file;
using offnominal::desk::RobotDescription;
using offnominal::desk::RobotEffect;
using offnominal::test::CommandResult;
using offnominal::test::parameter_of;
using offnominal::test::run_command;

// The effect's number of that name; a failure and NaN where the robot has no such effect.
double number_of(const RobotDescription& robot, EffectKind kind, int joint,
                 const std::string& name) {
  for (const RobotEffect& effect : robot.effects) {
    if (effect.kind == kind && effect.joint == joint) return parameter_of(effect, name);
  }
  ADD_FAILURE() << info_of(kind)->name << " is not on joint " << joint + 1;
  return std::nan("");
}

TEST(Walkthrough, ThePapersArmGetsWhatItsSimulatorHas) {
  const offnominal::test::TemporaryFolder folder;
  const auto path = [&folder](const char* name) { return (folder / name).string(); };
  const std::string robot_file = (offnominal::test::kRobots / "two_link.toml").string();
  // The domain in which the paper's bound holds, as limits of the motion.
  RobotDescription gentle = read_robot_file(robot_file);
  for (auto& joint : gentle.joints) {
    joint.joint.min_position = -0.5;
    joint.joint.max_position = 0.5;
    joint.joint.max_velocity = 0.8;
  }
  write_robot_file(gentle, path("gentle.toml"));
  const std::vector<std::vector<std::string>> commands{
      {"motion", "--robot", path("gentle.toml"), "--duration", "60", "-o", path("motion.csv")},
      {"paper", "--fault", "none", "--motion", path("motion.csv"), "--log", path("rich.csv")},
      {"add", "--all-found", "--robot", robot_file, "--log", path("rich.csv"), "-o",
       path("found.toml")}};
  for (const std::vector<std::string>& arguments : commands) {
    const CommandResult result = run_command(offnominal::test::command_file(), arguments);
    ASSERT_EQ(result.exit_code, 0) << arguments[0] << "\n" << result.out << result.err;
  }
  const CommandResult again =
      run_command(offnominal::test::command_file(),
                  {"explain", path("rich.csv"), "--robot", path("found.toml")});
  EXPECT_TRUE(again.out.starts_with("explained: ")) << again.out;
  const RobotDescription found = read_robot_file(path("found.toml"));
  EXPECT_EQ(found.effects.size(), 5U);
  EXPECT_NEAR(number_of(found, EffectKind::kCoulombFriction, 0, "level"), 0.5, 0.02);
  EXPECT_NEAR(number_of(found, EffectKind::kViscousFriction, 0, "coefficient"), 2.0, 0.05);
  EXPECT_NEAR(number_of(found, EffectKind::kViscousFriction, 1, "coefficient"), 2.5, 0.05);
  for (const int joint : {0, 1}) {
    EXPECT_NEAR(number_of(found, EffectKind::kPeriodicDisturbance, joint, "frequency"), 30, 0.01);
  }
}

}  // namespace
