#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "support/places.hpp"

// What offnominal-controller says before it touches a bus.

namespace offnominal::desk {
namespace {

using test::CommandResult;
using testing::HasSubstr;
using testing::StartsWith;

void expect_refusal(const CommandResult& result) {
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

TEST(Controller, RefusesInTheWordsOfTheCommand) {
  const auto controller = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"--bus", "vcan0"});
    return test::run_command(test::controller_file(), std::move(words));
  };
  const test::TemporaryFolder folder;
  const std::string robot = (folder / "r.toml").string();
  std::string text = test::content_of(test::source_dir() / "robots" / "two_link.toml");
  text.resize(text.find("[uncertainty_bound]"));
  test::put(robot, text);
  const CommandResult unbound = controller({"--robot", robot});
  expect_refusal(unbound);
  EXPECT_THAT(unbound.err, StartsWith(robot + ": uncertainty_bound: found nothing; allowed: a "
                                              "table [uncertainty_bound]"));
  const CommandResult typed = controller({"--duratin", "1"});
  expect_refusal(typed);
  EXPECT_THAT(typed.err, HasSubstr("write --duration, or run"));
  // Replacing what it reads would end the robot file before it is read.
  const CommandResult onto = controller({"--robot", robot, "--log", robot, "--force"});
  expect_refusal(onto);
  EXPECT_THAT(onto.err, HasSubstr("--log: found " + robot + ", which is that of --robot"));
  EXPECT_EQ(test::content_of(robot), text);
}

}  // namespace
}  // namespace offnominal::desk
