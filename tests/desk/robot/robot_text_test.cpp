#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>

#include "common/error.hpp"
#include "desk/support/temporary_folder.hpp"
#include "expect_same_robot.hpp"
#include "random_robot.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"
#include "support/seed.hpp"

namespace offnominal::desk {
namespace {

using testing::HasSubstr;

TEST(RobotText, IsReadBackAsTheSameRobotToTheBit) {
  auto generator = test::seeded_generator();
  test::RandomRobot random(generator);
  for (int i = 0; i < 300 && !testing::Test::HasFailure(); ++i) {
    const RobotDescription robot = random.draw();
    const std::string text = robot_text(robot);
    SCOPED_TRACE(text);
    test::expect_same(robot, parse_robot(text, "written.toml"));
  }
}

TEST(RobotText, KeepsWhatWasReadFromAFile) {
  const RobotDescription robot = parse_robot(test::kSampleRobot, "sample.toml");
  const std::string text = robot_text(robot);
  test::expect_same(robot, parse_robot(text, "written.toml"));
  EXPECT_THAT(text, HasSubstr("bits = 17"));
  EXPECT_THAT(text, HasSubstr("fitted = true"));
  EXPECT_THAT(text, HasSubstr("source = \"add, log A\""));
}

TEST(WriteRobotFile, WritesANewFileAndNeverOverAnother) {
  const test::TemporaryFolder folder;
  RobotDescription robot = parse_robot(test::kSampleRobot, "sample.toml");
  write_robot_file(robot, folder / "r.toml");
  test::expect_same(robot, read_robot_file(folder / "r.toml"));
  robot.name = "another";
  EXPECT_THROW(write_robot_file(robot, folder / "r.toml"), InputError);
  EXPECT_EQ(read_robot_file(folder / "r.toml").name, "sample");
  write_robot_file(robot, folder / "r.toml", Existing::kReplace);
  EXPECT_EQ(read_robot_file(folder / "r.toml").name, "another");
}

TEST(WriteRobotFile, KeepsTheDbcFileWhereverItWrites) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  const std::string text = test::changed(test::kSampleRobot, "[channels]\n",
                                         "# kept\n[channels]\ndbc = \"drive.dbc\"\n");
  test::put(folder / "r.toml", text);
  RobotDescription robot = read_robot_file(folder / "r.toml");
  const std::string dbc = (folder / "drive.dbc").string();
  EXPECT_EQ(robot.channels->dbc, dbc);
  write_robot_file(robot, folder / "beside.toml");
  EXPECT_EQ(test::content_of(folder / "beside.toml"), text);
  write_robot_file(robot, folder / "there" / "r.toml");
  EXPECT_EQ(read_robot_file(folder / "there" / "r.toml").channels->dbc, dbc);
  EXPECT_THAT(test::content_of(folder / "there" / "r.toml"), HasSubstr("# kept"));
  robot.file_text = nullptr;
  write_robot_file(robot, folder / "there" / "anew.toml");
  EXPECT_EQ(read_robot_file(folder / "there" / "anew.toml").channels->dbc, dbc);
}

TEST(WriteRobotFile, WritesNoRobotThatCouldNotBeReadAgain) {
  const test::TemporaryFolder folder;
  RobotDescription robot = parse_robot(test::kSampleRobot, "sample.toml");
  robot.effects[1].parameters[0] = std::numeric_limits<double>::quiet_NaN();
  try {
    write_robot_file(robot, folder / "r.toml");
    ADD_FAILURE() << "written";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("effect[2].coefficient: found nan"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "r.toml"));
}

}  // namespace
}  // namespace offnominal::desk
