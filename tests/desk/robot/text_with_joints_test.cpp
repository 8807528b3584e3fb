#include "robot/text_with_joints.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/file.hpp"
#include "desk/support/temporary_folder.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"

namespace offnominal::desk {
namespace {

using testing::HasSubstr;

const std::string kHandMade =
    test::changed(test::changed(test::kSampleRobot, "mass_kg = 2.5", "mass_kg = 2.5  # weighed"),
                  "name = \"slide\"", "# the lift, \xc3\xa4ndert sich\nname = \"slide\"");

TEST(TextWithJoints, PutsNumbersInTheirPlacesAndKeepsAllElse) {
  RobotDescription robot = parse_robot(kHandMade, "r.toml");
  robot.joints[0].joint.mass_kg = 2.625;
  robot.joints[0].joint.inertia_kg_m2[1] = 0.0325;
  robot.joints[0].source = "drawing 12, Maße nach Fit";
  robot.joints[1].source = "fitted";
  std::string wanted = test::changed(kHandMade, "mass_kg = 2.5 ", "mass_kg = 2.625 ");
  wanted = test::changed(wanted, "yy = 0.03,", "yy = 0.0325,");
  wanted = test::changed(wanted, "\"drawing 12\"", "\"drawing 12, Maße nach Fit\"");
  wanted = test::changed(wanted, "name = \"slide\"\n", "name = \"slide\"\nsource = \"fitted\"\n");
  EXPECT_EQ(text_with_joints(kHandMade, robot, "r.toml"), wanted);
  EXPECT_EQ(text_with_joints(wanted, robot, "r.toml"), wanted);
}

// GIVEN a file with comments WHEN a fit changes masses beside an effect THEN it is written with
// them.
TEST(TextWithJoints, KeepsTheCommentsOfAFileWhoseLinksWereFitted) {
  const test::TemporaryFolder folder;
  RobotDescription robot = parse_robot(kHandMade, "r.toml");
  robot.joints[1].joint.mass_kg = 1.125;
  robot.effects.pop_back();
  EXPECT_EQ(write_robot_file(robot, folder / "new.toml", Existing::kRefuse), KeptComments::kAll);
  const std::string text = read_text_file(folder / "new.toml");
  EXPECT_THAT(text, HasSubstr("# weighed"));
  EXPECT_THAT(text, HasSubstr("mass_kg = 1.125"));
}

TEST(TextWithJoints, IsNoneWhereAKeyStandsNowhere) {
  RobotDescription robot = parse_robot(kHandMade, "r.toml");
  robot.joints[1].joint.inertia_kg_m2 = {0.1, 0.1, 0.1, 0, 0, 0};
  EXPECT_FALSE(text_with_joints(kHandMade, robot, "r.toml"));
}

}  // namespace
}  // namespace offnominal::desk
