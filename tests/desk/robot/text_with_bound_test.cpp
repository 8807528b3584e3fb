#include "robot/text_with_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "desk/support/temporary_folder.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

const std::string kHead =
    "# kept\nformat = 1\nname = \"r\" # kept too\ngravity_m_s2 = [0.0, 0.0, -9.81]\n\n[[joint]]\n"
    "name = \"j\"\ntype = \"prismatic\"\naxis = [1.0, 0.0, 0.0]\n\n[joint.link]\nmass_kg = 2\n"
    "centre_of_mass_m = [0.0, 0.0, 0.0]\n";
const std::string kOldBound =
    "\n# section 5: 4.4\n# found empirically\n[uncertainty_bound]\nkind = \"constant\" # old\n"
    "value = 4.4\n";
const std::string kTail =
    "\n# the recording's names\n[channels]\nposition = \"x\"\ntorque = \"F\"\n";
const std::string kNewBound =
    "\n[uncertainty_bound]\nkind = \"constant\"\nvalue = 0.5\nvelocity_error = 0.25\n";

RobotDescription with_new_bound(const std::string& text) {
  RobotDescription robot = parse_robot(text, "r.toml");
  robot.bound.emplace();
  robot.bound->constant.value = 0.5;
  robot.bound->velocity_error = 0.25;
  return robot;
}

TEST(TextWithBound, TheOldBoundGoesWithTheCommentThatSpeaksOfIt) {
  const std::string text = kHead + kOldBound + kTail;
  EXPECT_EQ(text_with_bound(text, with_new_bound(text)), kHead + kNewBound + kTail);
}

// Bounds joint by joint, with a table over speed each, written as tables of their own.
TEST(TextWithBound, TheTablesOfTheOldBoundGoWithItWhereTheyHaveHeaders) {
  const auto over_speed = [](const std::string& value) {
    return "\n[[uncertainty_bound.over_speed]] # by hand\njoint = 1\nat = [0.0, 1.0]\nvalue = " +
           value + "\n";
  };
  const std::string head = kHead + "\n[estimator]\nspace = \"torque\" # kept as well\n";
  const std::string bound =
      "\n[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [0.0]\n# of the slide\n";
  const std::string text = head + bound + over_speed("[1.0, 2.0]") + kTail;
  RobotDescription robot = parse_robot(text, "r.toml");
  robot.bound->joints[0].value = {3, 4};
  const auto written = text_with_bound(text, robot);
  ASSERT_TRUE(written) << "the comments of the file are lost";
  EXPECT_EQ(written->substr(0, head.size()), head);
  EXPECT_EQ(written->substr(written->size() - kTail.size()), kTail);
  EXPECT_EQ(written->find("by hand"), std::string::npos);
  EXPECT_EQ(parse_robot(*written, "r.toml").bound->joints[0].value, (std::vector{3.0, 4.0}));
  // The same where they are the last lines of the file.
  EXPECT_TRUE(text_with_bound(head + kTail + bound + over_speed("[1.0, 2.0]"), robot));
}

TEST(TextWithBound, TheTableOfTheSecondFilterGoesWithItWhereItHasAHeader) {
  const std::string head =
      kHead + "\n[estimator]\nspace = \"torque\" # kept as well\nfast_alpha_per_s = 50.0\n";
  const std::string text = head +
                           "\n[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.0]\n"
                           "\n[uncertainty_bound.fast] # by hand\nvalue = [2.0]\n" +
                           kTail;
  RobotDescription robot = parse_robot(text, "r.toml");
  robot.bound->fast[0].value = {5};
  const auto written = text_with_bound(text, robot);
  ASSERT_TRUE(written) << "the comments of the file are lost";
  EXPECT_EQ(written->substr(0, head.size()), head);
  EXPECT_EQ(written->find("by hand"), std::string::npos);
  EXPECT_EQ(parse_robot(*written, "r.toml").bound->fast[0].value, std::vector{5.0});
}

// Tables of TOML may stand anywhere.
TEST(TextWithBound, ATableOfTheOldBoundGoesWithItBehindOthersToo) {
  const std::string head =
      kHead + "\n[estimator]\nspace = \"torque\" # kept as well\nfast_alpha_per_s = 50.0\n";
  const std::string text = head + "\n[uncertainty_bound]\nkind = \"per_joint\"\nvalue = [1.0]\n" +
                           kTail + "\n# of the second\n[uncertainty_bound.fast]\nvalue = [2.0]\n";
  RobotDescription robot = parse_robot(text, "r.toml");
  robot.bound->fast[0].value = {5};
  const auto written = text_with_bound(text, robot);
  ASSERT_TRUE(written) << "the comments of the file are lost";
  EXPECT_EQ(written->substr(0, head.size()), head);
  EXPECT_NE(written->find(kTail), std::string::npos);
  EXPECT_EQ(written->find("of the second"), std::string::npos);
  EXPECT_EQ(parse_robot(*written, "r.toml").bound->fast[0].value, std::vector{5.0});
}

// Above all headers there is no place for a table: the new bound goes to the end, and what stands
// above the old one may speak of the whole file.
TEST(TextWithBound, ABoundInOneLineGoesAndEveryOtherLineStays) {
  const std::string rest = kHead.substr(kHead.find('\n') + 1) + kTail;
  for (const std::string bound :
       {"uncertainty_bound = {kind = \"constant\", value = 4.4} # by hand\n",
        "uncertainty_bound.kind = \"table\"\nuncertainty_bound.variable = \"speed\"\n"
        "uncertainty_bound.joint = 1\nuncertainty_bound.at = [\n  0.0, # slow\n  1.0\n]\n"
        "uncertainty_bound.value = [1.0, 2.0]\n"}) {
    const std::string text = "# kept\n" + bound + rest;
    EXPECT_EQ(text_with_bound(text, with_new_bound(text)), "# kept\n" + rest + kNewBound);
  }
}

TEST(TextWithBound, AFirstBoundFollowsTheLastLine) {
  const std::string text = kHead + kTail;
  EXPECT_EQ(text_with_bound(text, with_new_bound(text)), text + kNewBound);
}

TEST(TextWithBound, OfARobotThatHasNoneItIsTakenOut) {
  const std::string text = kHead + kOldBound + kTail;
  RobotDescription robot = parse_robot(text, "r.toml");
  robot.bound.reset();
  const auto without = text_with_bound(text, robot);
  ASSERT_TRUE(without);
  EXPECT_EQ(without->find("[uncertainty_bound]"), std::string::npos);
  EXPECT_FALSE(parse_robot(*without, "r.toml").bound);
}

TEST(TextWithBound, ChangesNothingWhereNothingChanged) {
  const std::string text = kHead + kOldBound + kTail;
  EXPECT_EQ(text_with_bound(text, parse_robot(text, "r.toml")), text);
}

TEST(TextWithBound, RefusesOtherChangesAndTextsThatItCannotCut) {
  const std::string text = kHead + kOldBound + kTail;
  RobotDescription robot = with_new_bound(text);
  robot.name = "other";
  EXPECT_FALSE(text_with_bound(text, robot));
  EXPECT_FALSE(text_with_bound("format = 1", with_new_bound(text)));
}

std::string with_returns_of(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return result;
}

TEST(TextWithBound, WritingEndsEveryLineAsTheFileDoes) {
  const test::TemporaryFolder folder;
  const std::string text = kHead + kOldBound + kTail;
  for (const std::string& old_text : {with_returns_of(text), with_returns_of(kHead) + kTail}) {
    RobotDescription robot = with_new_bound(old_text);
    EXPECT_EQ(write_robot_file(robot, folder / "new.toml", Existing::kReplace), KeptComments::kAll);
    const std::string written = test::content_of(folder / "new.toml");
    EXPECT_NE(written.find("# kept\r\n"), std::string::npos);
    EXPECT_NE(written.find("value = 0.5\r\n"), std::string::npos);
    EXPECT_EQ(std::count(written.begin(), written.end(), '\n'),
              std::count(written.begin(), written.end(), '\r'));
    // An effect that is new as well, and what cannot be cut.
    RobotEffect effect;
    effect.kind = EffectKind::kViscousFriction;
    effect.parameters[0] = 3;
    robot.effects.push_back(effect);
    robot.name = "other";
    EXPECT_EQ(write_robot_file(robot, folder / "new.toml", Existing::kReplace),
              KeptComments::kNone);
    const std::string anew = test::content_of(folder / "new.toml");
    EXPECT_EQ(std::count(anew.begin(), anew.end(), '\n'),
              std::count(anew.begin(), anew.end(), '\r'));
  }
}

TEST(TextWithBound, WritingSaysWhereCommentsAreLost) {
  const test::TemporaryFolder folder;
  const auto written = [&](const std::string& text) {
    return write_robot_file(with_new_bound(text), folder / "new.toml", Existing::kReplace);
  };
  const std::string quoted = "\n[\"uncertainty_bound\"]\nkind = \"constant\"\nvalue = 4.4\n";
  EXPECT_EQ(written(kHead + quoted), KeptComments::kNone);
  EXPECT_EQ(written(kHead + kOldBound), KeptComments::kAll);
  const std::string bare = "format = 1\nname = \"r\"\n" + kHead.substr(kHead.find("gravity"));
  EXPECT_EQ(written(bare + quoted), KeptComments::kAll) << "there are none";
}

TEST(TextWithBound, WritingKeepsTheRestOfTheFileEvenWhereEffectsChangedToo) {
  const test::TemporaryFolder folder;
  const std::string text = kHead + kOldBound + kTail;
  RobotDescription robot = with_new_bound(text);
  RobotEffect effect;
  effect.kind = EffectKind::kViscousFriction;
  effect.parameters[0] = 3;
  robot.effects.push_back(effect);
  write_robot_file(robot, folder / "new.toml");
  const std::string written = test::content_of(folder / "new.toml");
  EXPECT_NE(written.find("# kept\n"), std::string::npos);
  EXPECT_NE(written.find("# the recording's names\n"), std::string::npos);
  EXPECT_NE(written.find("viscous_friction"), std::string::npos);
  EXPECT_EQ(written.find("section 5"), std::string::npos);
  EXPECT_EQ(robot_text(read_robot_file(folder / "new.toml")), robot_text(robot));
}

}  // namespace
}  // namespace offnominal::desk
