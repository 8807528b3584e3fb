#include "robot/text_with_effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "common/file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "expect_same_robot.hpp"
#include "random_robot.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"
#include "support/robots.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

const std::string kCommented = test::changed(
    test::changed(test::kSampleRobot, "[[effect]]\nkind = \"viscous_friction\"",
                  "# grease of May\n[[effect]] # by hand\nkind = \"viscous_friction\""),
    "[estimator]", "# tuned on the bench\n[estimator]");

RobotEffect offset(double level) {
  RobotEffect effect;
  effect.kind = EffectKind::kTorqueOffset;
  effect.parameters[0] = level;
  return effect;
}

TEST(TextWithEffects, ChangesNothingWhereNothingChanged) {
  const RobotDescription robot = parse_robot(kCommented, "r.toml");
  EXPECT_EQ(text_with_effects(kCommented, robot), kCommented);
}

TEST(TextWithEffects, PutsANewEffectBehindTheLast) {
  RobotDescription robot = parse_robot(kCommented, "r.toml");
  robot.effects.push_back(offset(0.25));
  const std::string wanted =
      test::changed(kCommented, "coefficient = 12\n",
                    "coefficient = 12\n\n[[effect]]\nkind = \"torque_offset\"\njoint = 1\n"
                    "level = 0.25\n");
  EXPECT_EQ(text_with_effects(kCommented, robot), wanted);
}

TEST(TextWithEffects, WritesAnotherJointAsAWholeNumber) {
  RobotDescription robot = parse_robot(kCommented, "r.toml");
  RobotEffect coupling;
  coupling.kind = EffectKind::kJointCoupling;
  coupling.joint = 1;
  coupling.parameters = {0.5, 0.0, 1.0, 0.25};
  robot.effects.push_back(coupling);
  const std::string wanted =
      test::changed(kCommented, "coefficient = 12\n",
                    "coefficient = 12\n\n[[effect]]\nkind = \"joint_coupling\"\njoint = 2\n"
                    "coefficient = 0.5\nlevel = 0.0\nsource_joint = 1\nsmoothing = 0.25\n");
  EXPECT_EQ(text_with_effects(kCommented, robot), wanted);
}

TEST(TextWithEffects, WritesOnlyTheChangedEffectAnew) {
  RobotDescription robot = parse_robot(kCommented, "r.toml");
  robot.effects[0].parameters[0] = 1.75;
  const std::string wanted =
      test::changed(kCommented, "joint = 1\nlevel = 1.5\nstribeck_velocity = 0.2\n",
                    "joint = 1\nlevel = 1.75\nstribeck_velocity = 0.2\nsmoothing = 0.01\n");
  EXPECT_EQ(text_with_effects(kCommented, robot), wanted);
}

TEST(TextWithEffects, TakesAwayTheLastEffect) {
  RobotDescription robot = parse_robot(kCommented, "r.toml");
  robot.effects.pop_back();
  const auto text = text_with_effects(kCommented, robot);
  ASSERT_TRUE(text);
  EXPECT_THAT(*text, testing::Not(testing::HasSubstr("viscous_friction")));
  EXPECT_THAT(*text, testing::HasSubstr("# tuned on the bench\n[estimator]"));
}

TEST(TextWithEffects, PutsTheFirstEffectAboveTheSettings) {
  const auto path = test::kRobots / "emps.toml";
  const std::string old = read_text_file(path);
  RobotDescription robot = read_robot_file(path);
  robot.effects.push_back(offset(-3.1648));
  const std::string wanted =
      test::changed(old, "[estimator]",
                    "[[effect]]\nkind = \"torque_offset\"\njoint = 1\nlevel = -3.1648\n\n"
                    "[estimator]");
  EXPECT_EQ(text_with_effects(old, robot), wanted);
}

TEST(TextWithEffects, KeepsACommentWithTheSettingsThatItIntroduces) {
  const auto effects = kCommented.find("[[effect]]");
  const auto settings = kCommented.find("# tuned on the bench");
  const std::string old = kCommented.substr(0, effects) + kCommented.substr(settings);
  RobotDescription robot = parse_robot(old, "r.toml");
  robot.effects.push_back(offset(0.25));
  const std::string wanted =
      test::changed(old, "# tuned on the bench\n",
                    "[[effect]]\nkind = \"torque_offset\"\njoint = 1\nlevel = 0.25\n\n"
                    "# tuned on the bench\n");
  EXPECT_EQ(text_with_effects(old, robot), wanted);
}

TEST(TextWithEffects, DeclinesWhatItCannotCut) {
  RobotDescription robot = parse_robot(kCommented, "r.toml");
  robot.joints[0].joint.mass_kg = 2.6;
  EXPECT_FALSE(text_with_effects(kCommented, robot)) << "more than effects has changed";
  EXPECT_FALSE(text_with_effects("", robot));
  EXPECT_FALSE(text_with_effects("not a robot", robot));
  const std::string inline_effects = test::changed(
      test::kSampleRobot.substr(0, test::kSampleRobot.find("[[effect]]")), "gravity_m_s2",
      "effect = [{kind = \"torque_offset\", joint = 1, level = 1.0}]\ngravity_m_s2");
  EXPECT_FALSE(text_with_effects(inline_effects, parse_robot(inline_effects, "r.toml")));
}

TEST(TextWithEffects, IsReadAsTheRobotOrDeclinesForRobotsOfEveryShape) {
  auto generator = test::seeded_generator();
  test::RandomRobot random(generator);
  int written = 0;
  for (int i = 0; i < 200 && !testing::Test::HasFailure(); ++i) {
    const std::string old = robot_text(random.draw());
    RobotDescription robot = parse_robot(old, "old.toml");
    for (RobotEffect& effect : robot.effects) {
      // Towards 0, which every range has room for.
      if (generator() % 3 == 0) effect.parameters[0] *= 0.75;
      if (generator() % 3 == 0) effect.source += "\n[estimator]\n[[effect]]\n";
    }
    while (!robot.effects.empty() && generator() % 4 == 0) robot.effects.pop_back();
    if (robot.effects.empty() || generator() % 2 == 0) robot.effects.push_back(offset(0.5));
    if (robot.effects.size() > kEffectsPerJoint * robot.joints.size()) robot.effects.pop_back();
    const auto text = text_with_effects(old, robot);
    if (!text) continue;
    ++written;
    SCOPED_TRACE(*text);
    test::expect_same(robot, parse_robot(*text, "new.toml"));
  }
  EXPECT_GT(written, 150);
}

TEST(WriteRobotFile, KeepsTheCommentsOfTheFileThatWasRead) {
  const test::TemporaryFolder folder;
  test::put(folder / "old.toml", kCommented);
  RobotDescription robot = read_robot_file(folder / "old.toml");
  robot.effects.push_back(offset(0.25));
  write_robot_file(robot, folder / "new.toml");
  const std::string text = test::content_of(folder / "new.toml");
  EXPECT_THAT(text, testing::HasSubstr("# grease of May\n[[effect]] # by hand\n"));
  EXPECT_THAT(text, testing::HasSubstr("# tuned on the bench\n"));
  EXPECT_EQ(read_robot_file(folder / "new.toml").effects.size(), 3U);
  EXPECT_EQ(test::content_of(folder / "old.toml"), kCommented);
}

}  // namespace
}  // namespace offnominal::desk
