#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

namespace offnominal::desk {
namespace {

using test::CommandResult;
using test::content_of;
using testing::HasSubstr;

const std::string kTwoLink = (test::kRobots / "two_link.toml").string();

CommandResult codegen(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "codegen");
  return test::run_command(test::command_file(), std::move(arguments));
}

TEST(CodegenVerb, WritesAHeaderAndSaysSo) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "model.hpp").string();
  const CommandResult result = codegen({kTwoLink, "-o", out, "--namespace", "arm", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["robot"], "two_link");
  EXPECT_EQ(json["written"], out);
  EXPECT_EQ(json["joints"], 2);
  EXPECT_EQ(json["scalars"], (std::vector<std::string>{"float", "double"}));
  EXPECT_THAT(content_of(out), HasSubstr("namespace arm {"));
}

TEST(CodegenVerb, ReplacesAFileOnlyWhenAsked) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "model.hpp").string();
  test::put(out, "mine");
  const CommandResult refused = codegen({kTwoLink, "-o", out});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("which is there already"));
  EXPECT_EQ(content_of(out), "mine");
  EXPECT_EQ(codegen({kTwoLink, "-o", out, "--force"}).exit_code, 0);
  EXPECT_THAT(content_of(out), HasSubstr("namespace robot_model {"));
}

TEST(CodegenVerb, WritesNothingForAWrongRobotAndNeverOverTheRobotItself) {
  const test::TemporaryFolder folder;
  const std::string robot = (folder / "robot.toml").string();
  test::put(robot, "format = 1\nname = \"r\"\nmass = 3\n");
  const CommandResult wrong = codegen({robot, "-o", (folder / "model.hpp").string()});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("line 3, mass: found an unknown key"));
  EXPECT_FALSE(std::filesystem::exists(folder / "model.hpp"));
  const CommandResult itself = codegen({robot, "-o", robot, "--force"});
  EXPECT_EQ(itself.exit_code, 2);
  EXPECT_THAT(itself.err, HasSubstr("which is that of ROBOT"));
  EXPECT_THAT(content_of(robot), HasSubstr("mass = 3"));
}

}  // namespace
}  // namespace offnominal::desk
