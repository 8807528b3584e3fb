#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "desk/support/temporary_folder.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

// `offnominal motion` as a user runs it.

namespace {

using nlohmann::json;
using offnominal::test::CommandResult;
using offnominal::test::content_of;
using offnominal::test::put;
using offnominal::test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kEmps = (offnominal::test::kRobots / "emps.toml").string();
const std::string kArm = (offnominal::test::kRobots / "two_link.toml").string();

class MotionVerb : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  CommandResult motion(const std::string& robot, std::vector<std::string> more) const {
    more.insert(more.begin(), {"motion", "--robot", robot, "-o", path("motion.csv"), "--duration",
                               "12", "--rate", "100", "--tries", "4"});
    return offnominal::test::run_command(offnominal::test::command_file(), more);
  }
  void expect_refusal(const CommandResult& result, const std::string& words) const {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "motion.csv"));
  }

  TemporaryFolder folder_;
};

TEST_F(MotionVerb, WritesTheMotionAndSaysWhatItDoes) {
  const CommandResult result =
      motion(kEmps, {"--separate", "coulomb_friction,viscous_friction", "--seed", "7"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, AllOf(HasSubstr("A motion of 12 s that tells apart coulomb_friction"),
                                HasSubstr("seed 7"), HasSubstr("written: ")));
  std::istringstream csv(content_of(folder_ / "motion.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "t,q1,dq1,ddq1");
  int rows = 0;
  while (std::getline(csv, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 3);
    ++rows;
  }
  EXPECT_EQ(rows, 1201);
  EXPECT_TRUE(line.empty() || line.starts_with("12,")) << line;
}

TEST_F(MotionVerb, SaysTheSameInJsonAndOnThePage) {
  const CommandResult result = motion(kArm, {"--separate", "coulomb_friction@1,stribeck_friction@1",
                                             "--json", "--report", path("page.html")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json said = json::parse(result.out);
  EXPECT_EQ(said["purpose"], "separate");
  EXPECT_EQ(said["effects"].size(), 2U);
  EXPECT_EQ(said["joints"].size(), 2U);
  EXPECT_EQ(said["joints"][1]["top_torque"]["unit"], "N m");
  ASSERT_EQ(said["pairs"].size(), 2U);
  EXPECT_EQ(said["pairs"][0]["effect"], "coulomb_friction");
  EXPECT_EQ(said["pairs"][0]["against"]["effect"], "stribeck_friction");
  EXPECT_GT(said["pairs"][0]["after"]["sine"], 0);
  const std::string page = content_of(folder_ / "page.html");
  EXPECT_THAT(page, HasSubstr(said["sentence"].get<std::string>()));
  EXPECT_THAT(page, HasSubstr("coulomb_friction@1"));
}

TEST_F(MotionVerb, ExcitesEverythingUnlessToldOtherwise) {
  const CommandResult all = motion(kEmps, {"--json"});
  ASSERT_EQ(all.exit_code, 0) << all.err;
  EXPECT_EQ(json::parse(all.out)["purpose"], "excite");
  EXPECT_GT(json::parse(all.out)["pairs"].size(), 10U);
  const CommandResult named = motion(kEmps, {"--excite", "all", "--json", "--force"});
  EXPECT_EQ(json::parse(named.out)["pairs"], json::parse(all.out)["pairs"]);
  const CommandResult one = motion(kEmps, {"--excite", "stribeck_friction@1", "--json", "--force"});
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(json::parse(one.out)["pairs"].size(), 1U);
}

TEST_F(MotionVerb, FailsAndWritesNothingWhereNoMotionHelps) {
  const CommandResult result = motion(kEmps, {"--separate", "link_mass,rotor_inertia"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("the same torque"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "motion.csv"));
}

TEST_F(MotionVerb, RefusesWhatItCannotUse) {
  expect_refusal(motion(kEmps, {"--separate", "coulomb_friction,stribek_friction"}),
                 "write stribeck_friction");
  expect_refusal(motion(kEmps, {"--separate", "coulomb_friction,joint_coupling"}), "can act");
  expect_refusal(motion(kEmps, {"--separate", "coulomb_friction@1,coulomb_friction"}), "twice");
  expect_refusal(motion(kEmps, {"--separate", "coulomb_friction"}), "--excite coulomb_friction@1");
  expect_refusal(motion(kArm, {"--excite", "backlash@3"}), "a joint from 1 to 2");
  expect_refusal(motion(path("none.toml"), {}), "none.toml");
  expect_refusal(motion(kEmps, {"--log", path("none.csv")}), "none.csv");
  EXPECT_EQ(motion(kEmps, {"--duration", "1"}).exit_code, 2);
  expect_refusal(motion(kEmps, {"--noise", "nan"}), "--noise: found nan; allowed: a number");
  EXPECT_EQ(motion(kEmps, {"--excite", "all", "--separate", "a,b"}).exit_code, 2);
}

TEST_F(MotionVerb, RefusesARobotWithoutLimits) {
  std::string text = content_of(kEmps);
  const auto begin = text.find("velocity = 0.5");
  ASSERT_NE(begin, std::string::npos);
  text.replace(begin, 14, "");
  put(folder_ / "free.toml", text);
  expect_refusal(motion(path("free.toml"), {}), "write velocity under [joint.limits]");
}

TEST_F(MotionVerb, LeavesFilesAloneThatAreThere) {
  put(folder_ / "motion.csv", "mine");
  const CommandResult result = motion(kEmps, {});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("--force"));
  EXPECT_EQ(content_of(folder_ / "motion.csv"), "mine");
  EXPECT_EQ(motion(kEmps, {"--force"}).exit_code, 0);
  EXPECT_THAT(content_of(folder_ / "motion.csv"), HasSubstr("t,q1"));
}

TEST_F(MotionVerb, ReplacesNothingThatItReads) {
  const std::string text = content_of(kEmps);
  put(folder_ / "motion.csv", text);
  put(folder_ / "robot.toml", text);
  const CommandResult output = motion(path("motion.csv"), {"--force"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_THAT(output.err, HasSubstr("which is that of --robot"));
  const CommandResult page =
      motion(path("robot.toml"), {"--force", "--report", path("robot.toml")});
  EXPECT_EQ(page.exit_code, 2);
  EXPECT_THAT(page.err, HasSubstr("which is that of --robot"));
  EXPECT_EQ(content_of(folder_ / "motion.csv"), text);
  EXPECT_EQ(content_of(folder_ / "robot.toml"), text);
}

TEST_F(MotionVerb, WritesAllOrNothing) {
  expect_refusal(motion(kEmps, {"--report", path("motion.csv")}), "which is that of --report");
  expect_refusal(motion(kEmps, {"--report", path("no/page.html")}), "no/page.html");
  EXPECT_FALSE(std::filesystem::exists(folder_ / "motion.csv"));
}

TEST_F(MotionVerb, SaysWhereItCannotWrite) {
  const CommandResult result =
      offnominal::test::run_command(offnominal::test::command_file(),
                                    {"motion", "--robot", kEmps, "-o", path("no/such/folder.csv"),
                                     "--duration", "12", "--rate", "100", "--tries", "2"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("no/such"));
}

}  // namespace
