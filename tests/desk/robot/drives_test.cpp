// [drives] of a robot file: what it says, what is wrong with it, and that it is written back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/file.hpp"
#include "common/number.hpp"
#include "desk/support/temporary_folder.hpp"
#include "drives/drive_table.hpp"
#include "expect_same_robot.hpp"
#include "robot/read_drives.hpp"
#include "robot/robot_file.hpp"
#include "sample_robot.hpp"
#include "support/places.hpp"

namespace offnominal::desk {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// As they stand in the sample, above the settings of the recordings.
const std::string kAxes = R"(protocol = "can_simple"  # as odrivetool says
node = [3, 44]
joint_per_turn = [6.25, -0.5]
)";

std::string sample_with(const std::string& drives) {
  return test::changed(test::kSampleRobot, kAxes, drives);
}

TEST(Drives, AreTheProjectsOwnWhereAFileDoesNotName) {
  const RobotDescription robot =
      parse_robot(test::changed(test::kSampleRobot, "[drives]\n" + kAxes, ""), "r.toml");
  EXPECT_FALSE(robot.drives.has_value());
  EXPECT_STREQ(protocol_of(robot.drive_settings()).name, "protected");
  EXPECT_THAT(robot_text(robot), testing::Not(HasSubstr("[drives]")));
}

TEST(Drives, HoldWhatTheFileSaysAndTheDefaultsElsewhere) {
  const RobotDescription robot = parse_robot(
      sample_with(kAxes + "torque_interval_s = 0.002\nsource = \"bench of May\"\n"), "r.toml");
  const DriveSettings& drives = robot.drives.value();
  EXPECT_STREQ(protocol_of(drives).name, "can_simple");
  EXPECT_THAT(drives.shared, ElementsAre(1, 0.001, 0.1, 0.002));
  EXPECT_THAT(drives.of_joints, ElementsAre(3, 6.25, 0, 44, -0.5, 0));
  EXPECT_EQ(drives.source, "bench of May");
}

TEST(Drives, AreReadBackAsTheyWereWritten) {
  for (const std::string& text : {std::string("protocol = \"protected\"\n"), kAxes,
                                  kAxes + "firmware = \"0.5\"\ntorque_interval_s = 0.001\n"
                                          "motor_nm_per_ampere = [0.04, -0.1]\n"}) {
    const RobotDescription robot = parse_robot(sample_with(text), "r.toml");
    const RobotDescription again = parse_robot(robot_text(robot), "written.toml");
    test::expect_same(robot, again);
    EXPECT_EQ(robot_text(robot), robot_text(again));
  }
}

// GIVEN a file with [drives] WHEN an effect is added to it, as verbs do, THEN its lines stay.
TEST(Drives, StayAsTheyAreWhereAVerbWritesTheFile) {
  const test::TemporaryFolder folder;
  RobotDescription robot = parse_robot(sample_with(kAxes), "r.toml");
  RobotEffect offset;
  offset.kind = EffectKind::kTorqueOffset;
  offset.parameters = {0.25};
  robot.effects.push_back(offset);
  write_robot_file(robot, folder / "out.toml");
  const std::string text = read_text_file(folder / "out.toml");
  EXPECT_THAT(text, HasSubstr("[drives]\n" + kAxes));
  test::expect_same(read_robot_file(folder / "out.toml"), robot);
  // Other drives are another file, and none that keeps the old lines.
  robot.drives->of_joints[0] = 5;
  write_robot_file(robot, folder / "changed.toml");
  EXPECT_THAT(read_text_file(folder / "changed.toml"), HasSubstr("node = [5, 44]\n"));
}

struct WrongDrives {
  std::string drives;
  std::string key;  // and where it stands
  std::string found;
  std::string allowed;
};

TEST(Drives, ThatAreWrongAreRefusedInOneLine) {
  const std::vector<WrongDrives> mistakes{
      {"", "drives.protocol", "nothing", "protected, can_simple"},
      {"protocol = \"canopen\"\n", "drives.protocol", "the string \"canopen\"",
       "protected, can_simple"},
      {"protocol = \"can_simpel\"\n", "drives.protocol", "the string \"can_simpel\"",
       "protected, can_simple; to mend: write \"can_simple\""},
      {"protocol = \"protected\"\nnode = [1, 2]\n", "drives.node", "an unknown key",
       "protocol, source"},
      {"protocol = \"can_simple\"\njoint_per_turn = [1.0, 1.0]\n", "drives.node", "nothing",
       "a list of 2 numbers"},
      {"protocol = \"can_simple\"\nnode = [1, 2]\n", "drives.joint_per_turn", "nothing",
       "a list of 2 numbers"},
      {test::changed(kAxes, "[3, 44]", "[3]"), "drives.node", "a list of 1", "a list of 2 numbers"},
      {test::changed(kAxes, "44", "64"), "drives.node[2]", "64", "a number from 0 to 63"},
      {test::changed(kAxes, "44", "-1"), "drives.node[2]", "-1", "a number from 0 to 63"},
      {test::changed(kAxes, "44", "4.5"), "drives.node", "4.5", "whole numbers from 0 to 63"},
      {test::changed(kAxes, "44", "3"), "drives.node", "3 for joints 1 and 2",
       "another one for every joint"},
      {test::changed(kAxes, "6.25", "0"), "drives.joint_per_turn", "0 for joint 1",
       "another number"},
      {test::changed(kAxes, "-0.5", "0"), "drives.joint_per_turn", "0 for joint 2",
       "correct number 2 of the list"},
      {kAxes + "firmware = \"0.4\"\n", "drives.firmware", "the string \"0.4\"", "0.5, 0.6"},
      {kAxes + "firmware = \"0.5\"\ntorque_interval_s = 0.001\n", "drives.motor_nm_per_ampere",
       "none, with firmware 0.5", "the motor's torque_constant"},
      {kAxes + "heartbeat_interval_s = 0.0505\n", "drives.heartbeat_interval_s",
       "a part of a millisecond", "whole milliseconds"},
      {kAxes + "heartbeat_interval_s = 0.0\n", "drives.heartbeat_interval_s", "0", "0.1"},
      {kAxes + "encoder_interval_s = 0.05\n", "drives.encoder_interval_s",
       "ticks without a reading", "at most estimator.period_s"},
  };
  for (const WrongDrives& mistake : mistakes) {
    std::string message = "accepted";
    try {
      static_cast<void>(parse_robot(sample_with(mistake.drives), "dir/r.toml"));
    } catch (const InputError& error) {
      message = error.what();
    }
    EXPECT_THAT(message, StartsWith("dir/r.toml: line ")) << mistake.drives;
    EXPECT_THAT(message, HasSubstr(", " + mistake.key + ": found " + mistake.found));
    EXPECT_THAT(message, HasSubstr("; allowed: ")) << mistake.drives;
    EXPECT_THAT(message.substr(std::min(message.find("; allowed"), message.size())),
                HasSubstr(mistake.allowed));
  }
}

std::string row_of(const hal::DriveKey& key, bool per_joint) {
  const auto quoted = [](const char* word) { return "`\"" + std::string(word) + "\"`"; };
  std::string allowed = per_joint ? "per joint: " : "";
  for (const char* word : key.words) allowed += (word == key.words[0] ? "" : ", ") + quoted(word);
  if (key.words.empty()) allowed += shortest(key.least) + " to " + shortest(key.most);
  const std::string otherwise = key.required ? "required"
                                : key.words.empty()
                                    ? shortest(key.otherwise)
                                    : quoted(key.words[static_cast<std::size_t>(key.otherwise)]);
  const std::string unit = std::string(key.unit).empty() ? "" : std::string(" ") + key.unit;
  return "| `" + std::string(key.name) + "` |" + unit + " | " + allowed + " | " + otherwise +
         " | " + key.meaning + " |\n";
}

// The document says of every protocol what its description says.
TEST(Drives, HaveTheirPlaceInTheDocument) {
  const std::string text = read_text_file(test::source_dir() / "docs/robot-file.md");
  for (const std::string& key : drives_keys()) EXPECT_THAT(text, HasSubstr("\n| `" + key + "` |"));
  for (const DriveProtocol& protocol : drive_protocols()) {
    EXPECT_THAT(text, HasSubstr("\n### `" + std::string(protocol.name) + "`\n"));
    std::string rows;
    for (const hal::DriveKey& key : protocol.keys) rows += row_of(key, false);
    for (const hal::DriveKey& key : protocol.joint_keys) rows += row_of(key, true);
    EXPECT_THAT(text, HasSubstr(rows)) << protocol.name;
  }
}

}  // namespace
}  // namespace offnominal::desk
