#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "desk/support/run_command.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"
#include "urdfs.hpp"

namespace offnominal::test {
namespace {

using testing::Contains;
using testing::HasSubstr;

CommandResult run(std::vector<std::string> words) {
  return run_command(command_file(), std::move(words));
}

TEST(ImportUrdfVerb, WritesARobotFileAndSaysWhatItDid) {
  const TemporaryFolder folder;
  const std::string out = (folder / "arm.toml").string();
  const std::string urdf = sample_arm().file.string();
  const CommandResult result = run({"import-urdf", urdf, "--tip", "hand", "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("sample_arm: 3 joints from `world` to `hand`\n"));
  EXPECT_THAT(result.out, HasSubstr("merged: link `cover` (0.4 kg) into `upper` (line 34)\n"));
  EXPECT_THAT(result.out, testing::EndsWith("written: " + out + "\n"));
  EXPECT_EQ(desk::read_robot_file(out).joint_count(), 3);

  const CommandResult again = run({"import-urdf", urdf, "--tip", "hand", "-o", out});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("which is there already"));
  const CommandResult json =
      run({"import-urdf", urdf, "--tip", "hand", "-o", out, "--force", "--json"});
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto object = nlohmann::json::parse(json.out);
  EXPECT_EQ(object["robot"], "sample_arm");
  EXPECT_EQ(object["tip"], "hand");
  EXPECT_EQ(object["joints"].size(), 3U);
  EXPECT_EQ(object["joints"][0]["coulomb_friction"], 1.25);
  EXPECT_EQ(object["notes"][0]["kind"], "merged");
  EXPECT_EQ(object["written"], out);
}

TEST(ImportUrdfVerb, WritesNothingWhereItHasToAsk) {
  const TemporaryFolder folder;
  const std::string out = (folder / "arm.toml").string();
  const CommandResult result = run({"import-urdf", sample_arm().file.string(), "-o", out});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_THAT(result.err, HasSubstr("--tip one of hand (3 joints)"));
  const CommandResult meant =
      run({"import-urdf", sample_arm().file.string(), "--tip", "hnd", "-o", out});
  EXPECT_THAT(meant.err, testing::StartsWith("offnominal import-urdf: --tip: found `hnd`"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST(ImportUrdfVerb, ReadsStandardInput) {
  const TemporaryFolder folder;
  const std::string out = (folder / "arm.toml").string();
  const auto piped = [&](const std::string& input) {
    return run_command(command_file(), {"import-urdf", "-", "--tip", "hand", "-o", out}, {}, input);
  };
  const CommandResult result = piped(sample_arm().file.string());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(desk::read_robot_file(out).joint_count(), 3);
  EXPECT_THAT(content_of(out), HasSubstr("URDF standard input"));
  std::filesystem::remove(out);
  put(folder / "arm.xacro", "<robot name=\"a\"><xacro:include filename=\"b\"/></robot>");
  EXPECT_THAT(piped((folder / "arm.xacro").string()).err,
              testing::AllOf(testing::StartsWith("standard input: line 1: found <xacro:include>"),
                             HasSubstr("xacro FILE | offnominal import-urdf - ")));
}

TEST(NewVerb, WritesTheGeometryOfATableAndBlanks) {
  const TemporaryFolder folder;
  put(folder / "table.csv", "a_m,alpha_deg,d_m,theta_deg\n0,90,0.4,0\n0.3,0,0,0\n");
  const std::string out = (folder / "arm.toml").string();
  const std::vector<std::string> words{"new", "--dh", (folder / "table.csv").string(), "-o", out};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = words;
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  };
  EXPECT_THAT(with({}).err,
              HasSubstr("no word on whether the table is a standard or a modified one"));
  for (const char* joints : {"6", "0", "-1", "99999999999999999999999", "1.5", "two"}) {
    const CommandResult refused = with({"--convention", "standard", "--joints", joints});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, testing::StartsWith(std::string("offnominal new: --joints: found ") +
                                                 joints + "; allowed: 2, the rows of "));
  }
  EXPECT_THAT(with({"--convention", "standard", "--name", ""}).err,
              testing::StartsWith("offnominal new: --name: found nothing; allowed: a name"));
  EXPECT_FALSE(std::filesystem::exists(out));
  const CommandResult done = with({"--convention", "standard", "--joints", "2"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("arm: 2 joints of a standard DH table\n"));
  const CommandResult used = run({"export-urdf", out, "-o", (folder / "arm.urdf").string()});
  EXPECT_EQ(used.exit_code, 2);
  EXPECT_THAT(used.err, HasSubstr("joint[1].link.mass_kg: found nothing"));
}

TEST(NewVerb, TellsNumbersThatMayBeOfAnotherUnit) {
  const TemporaryFolder folder;
  put(folder / "table.csv", "a_m,alpha_deg,d_m,theta_deg\n0,1.5708,0.4,0\n");
  const CommandResult result = run({"new", "--dh", (folder / "table.csv").string(), "--convention",
                                    "standard", "-o", (folder / "arm.toml").string()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("note: alpha_deg = 1.5708 is pi/2 as radians"));
}

TEST(NewVerb, ReadsATableFromStandardInput) {
  const TemporaryFolder folder;
  put(folder / "table.csv", "a_m,alpha_deg,d_m,theta_deg\n0,90,0.4,0\n");
  const std::string out = (folder / "arm.toml").string();
  const CommandResult result =
      run_command(command_file(), {"new", "--dh", "-", "--convention", "standard", "-o", out}, {},
                  (folder / "table.csv").string());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(content_of(out), HasSubstr("standard DH table standard input"));
}

TEST(NewVerb, SaysWhichNamesATableWithoutUnitsShouldHave) {
  const TemporaryFolder folder;
  const auto error_of = [&](const std::string& header) {
    put(folder / "table.csv", header + "\n0,90,0.4,0\n");
    return run({"new", "--dh", (folder / "table.csv").string(), "--convention", "standard", "-o",
                (folder / "arm.toml").string()})
        .err;
  };
  EXPECT_THAT(error_of("a,alpha,d,theta"),
              HasSubstr("to mend: name it a_m where it is in metres, a_mm where in millimetres"));
  EXPECT_THAT(error_of("a_m,Alpha,d,theta"),
              HasSubstr("name it alpha_deg where it is in degrees, alpha_rad where in radians"));
  EXPECT_THAT(error_of("a_m,alpha_deg,d,theta"), HasSubstr("name it d_m where it is in metres"));
}

TEST(ExportVerbs, WriteBothFormatsAndListWhatIsNotCarried) {
  const TemporaryFolder folder;
  for (const std::string format : {"mjcf", "urdf"}) {
    const std::string out = (folder / ("arm." + format)).string();
    const std::string robot = (kRobots / "bam_xl330.toml").string();
    const CommandResult result = run({"export-" + format, robot, "-o", out});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, testing::EndsWith("written: " + out + "\n"));
    EXPECT_THAT(result.err, HasSubstr("not carried: the settings of estimator and arming\n"));
    EXPECT_THAT(content_of(out), HasSubstr("not carried: the settings of estimator and arming"));
    EXPECT_EQ(run({"export-" + format, robot, "-o", out}).exit_code, 2);
    const CommandResult json = run({"export-" + format, robot, "-o", out, "--force", "--json"});
    ASSERT_EQ(json.exit_code, 0) << json.err;
    EXPECT_THAT(nlohmann::json::parse(json.out)["not_carried"],
                Contains("the settings of estimator and arming"));
  }
}

}  // namespace
}  // namespace offnominal::test
