#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/error.hpp"
#include "robot/robot_file.hpp"

// Robot files whose masses are not known yet, as `offnominal new` writes them.

namespace offnominal::desk {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kBlank = R"(format = 1
name = "arm"
gravity_m_s2 = [0, 0, -9.81]
[[joint]]
name = "first"
type = "revolute"
axis = [0, 0, 1]
[joint.link]
mass_kg = 2
# centre_of_mass_m =   # blank
[[joint]]
name = "second"
type = "revolute"
axis = [0, 0, 1]
[joint.link]
# mass_kg =            # blank
# centre_of_mass_m =   # blank
)";

TEST(Blanks, AreListedWhereTheyAreAllowed) {
  const RobotDescription robot = parse_robot(kBlank, "arm.toml", Blanks::kAllowed);
  EXPECT_THAT(robot.blanks, ElementsAre(Blank{0, "centre_of_mass_m"}, Blank{1, "mass_kg"},
                                        Blank{1, "centre_of_mass_m"}));
  EXPECT_EQ(robot.joint_count(), 2);
}

TEST(Blanks, AreRefusedElsewhereWithTheFirstAndHowManyMore) {
  try {
    static_cast<void>(parse_robot(kBlank, "arm.toml"));
    FAIL() << "it was taken";
  } catch (const InputError& error) {
    for (const char* words : {"arm.toml: line 8, joint[1].link.centre_of_mass_m",
                              "the key is missing (and 2 more blanks in this file)",
                              "add `centre_of_mass_m` to joint[1].link", "offnominal identify"}) {
      EXPECT_THAT(error.what(), HasSubstr(words));
    }
  }
}

TEST(Blanks, AreNeverWrittenAsIfTheyWereNumbers) {
  const RobotDescription robot = parse_robot(kBlank, "arm.toml", Blanks::kAllowed);
  EXPECT_THROW(write_robot_file(robot, "never_written.toml"), InputError);
}

TEST(Blanks, DoNotHideWhatIsWrong) {
  std::string wrong = kBlank;
  wrong.replace(wrong.find("mass_kg = 2"), 11, "mass_kg = -2");
  EXPECT_THROW(static_cast<void>(parse_robot(wrong, "arm.toml", Blanks::kAllowed)), InputError);
}

}  // namespace
}  // namespace offnominal::desk
