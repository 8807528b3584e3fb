#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/support/run_command.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

// `offnominal paper` as a user runs it.

namespace offnominal::desk {
namespace {

using nlohmann::json;
using test::CommandResult;
using testing::HasSubstr;

CommandResult paper(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "paper");
  return test::run_command(test::command_file(), std::move(arguments));
}

// Dozens of runs: where the sanitizers watch, with a tick four times as long.
CommandResult paper_often(std::vector<std::string> arguments) {
#ifdef OFFNOMINAL_SANITIZE
  arguments.insert(arguments.end(), {"--step", "0.004"});  // as quick_arm.hpp
#endif
  return paper(std::move(arguments));
}

TEST(PaperVerb, OneRunAsJson) {
  const CommandResult result = paper({"--fault", "mass_loss", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json run = json::parse(result.out);
  EXPECT_EQ(run["fault"], "mass_loss");
  EXPECT_EQ(run["fault_time_s"], 10.0);
  EXPECT_NEAR(run["detection_time_s"].get<double>(), 10.6, 0.1);
  EXPECT_EQ(run["max_abs_psi_hat_before_fault"], 0.0);
  EXPECT_EQ(run["steps"], 20000);
  EXPECT_EQ(run["scalar"], "float");
  EXPECT_EQ(run["seed"], 1);
}

TEST(PaperVerb, OptionsReachTheRun) {
  const CommandResult result = paper(
      {"--fault", "nonlinear", "--rho", "inf", "--accommodate", "--scalar", "double", "--dead-zone",
       "discontinuous", "--hidden", "40", "--step", "0.002", "--seed", "9", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json run = json::parse(result.out);
  EXPECT_EQ(run["fault"], "nonlinear");
  EXPECT_EQ(run["accommodate"], true);
  EXPECT_EQ(run["scalar"], "double");
  EXPECT_EQ(run["steps"], 10000);
  EXPECT_EQ(run["seed"], 9);
  EXPECT_LT(run["detection_time_s"].get<double>(), 11.0) << "an abrupt fault is seen sooner";
}

TEST(PaperVerb, RunWithoutFaultSaysSo) {
  const CommandResult result = paper({"--fault", "none"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.out, HasSubstr("There is no fault and no alarm."));
  const json run = json::parse(paper({"--fault", "none", "--json"}).out);
  EXPECT_TRUE(run["detection_time_s"].is_null());
}

TEST(PaperVerb, EverythingBesideThePaperWithItsPage) {
  const test::TemporaryFolder folder;
  const std::string page = (folder / "paper.html").string();
  const CommandResult result = paper_often({"--report", page});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("10.6 s"));
  EXPECT_THAT(result.out, HasSubstr("agree with it."));
  EXPECT_THAT(result.out, HasSubstr("written: " + page));
  const std::string html = test::content_of(page);
  for (int figure = 8; figure <= 15; ++figure) {
    EXPECT_THAT(html, HasSubstr("Figure " + std::to_string(figure) + ":"));
  }
  EXPECT_THAT(html, HasSubstr("--report " + page)) << "the command line";
}

TEST(PaperVerb, SweepAsJson) {
  const CommandResult result = paper_often({"--sweep", "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json sweep = json::parse(result.out);
  EXPECT_EQ(sweep["resolution"], 0.005);
  EXPECT_GT(sweep["smallest_detected_mass_loss"].get<double>(), 0.075);
  EXPECT_LE(sweep["smallest_detected_mass_loss"].get<double>(), 0.10 + 1e-9);
}

TEST(PaperVerb, SweepPrintsEveryProbe) {
  const CommandResult result = paper_often({"--sweep"});
  EXPECT_THAT(result.out, HasSubstr("mass loss   7.5 %  not detected"));
  EXPECT_THAT(result.out, HasSubstr("mass loss  10.0 %  detected at"));
  EXPECT_THAT(result.out, HasSubstr("smallest mass loss that is detected:"));
}

TEST(PaperVerb, PlaceOfTheRobotFileIsNamedInItsErrors) {
  const std::string emps = (test::kRobots / "emps.toml").string();
  const CommandResult result = paper({"--fault", "none", "--robot", emps});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("1 joint"));
}

TEST(PaperVerb, OwnRobotFileGivesTheSameAsTheBuiltInOne) {
  const std::string file = (test::kRobots / "two_link.toml").string();
  EXPECT_EQ(paper({"--fault", "nonlinear", "--json", "--robot", file}).out,
            paper({"--fault", "nonlinear", "--json"}).out);
}

TEST(PaperVerb, ARecordedRunReplaysAsItRan) {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "run.csv").string();
  const std::vector<std::string> arguments{"--fault",    "none",  "--start",  "1.5",
                                           "--duration", "5",     "--scalar", "double",
                                           "--json",     "--log", log};
  const CommandResult run = paper(arguments);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::string robot = (test::kRobots / "two_link.toml").string();
  const CommandResult replayed =
      test::run_command(test::command_file(), {"replay", log, "--robot", robot, "--json"});
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const json told = json::parse(replayed.out);
  EXPECT_EQ(told["samples"], 5001);
  EXPECT_NEAR(told["max_error_to_threshold"].get<double>(),
              json::parse(run.out)["max_error_to_threshold_before_fault"].get<double>(), 1e-6);
  const CommandResult again = paper(arguments);
  EXPECT_EQ(again.exit_code, 2) << "a recording is not replaced unasked";
  EXPECT_THAT(again.err, HasSubstr(log));
}

TEST(PaperVerb, TwoRobotFilesSideBySide) {
  const test::TemporaryFolder folder;
  const std::string file = (test::kRobots / "two_link.toml").string();
  const std::string page = (folder / "sweep.html").string();
  const CommandResult result =
      paper_often({"--sweep", "--against", file, "--json", "--report", page});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json pair = json::parse(result.out);
  EXPECT_EQ(pair["before"]["robot"], file);
  EXPECT_EQ(pair["before"]["smallest_detected_mass_loss"],
            pair["after"]["smallest_detected_mass_loss"]);
  EXPECT_THAT(test::content_of(page), HasSubstr("Smallest mass loss that is detected"));
}

struct Wrong {
  std::vector<std::string> arguments;
  std::string told;
};

class PaperVerbRefuses : public testing::TestWithParam<Wrong> {};

TEST_P(PaperVerbRefuses, WithOneLineAndExitTwo) {
  const CommandResult result = paper(GetParam().arguments);
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr(GetParam().told));
}

INSTANTIATE_TEST_SUITE_P(
    Options, PaperVerbRefuses,
    testing::Values(
        Wrong{{"--fault", "broken"}, "{none,mass_loss,nonlinear}"},
        Wrong{{"--mass-loss", "1"}, "--mass-loss: found 1; allowed: 0 to below 1"},
        Wrong{{"--mass-loss", "nan"}, "--mass-loss: found nan"},
        Wrong{{"--mass-loss", "much"}, "--mass-loss: found much"},
        Wrong{{"--fault", "mass_loss", "--rho", "0"}, "--rho: found 0; allowed: above 0, or inf"},
        Wrong{{"--fault", "mass_loss", "--rho", "nan"}, "--rho: found nan"},
        Wrong{{"--hidden", "0"}, "--hidden: found 0; allowed: a whole number from 1 to 128"},
        Wrong{{"--hidden", "2.5"}, "--hidden: found 2.5"},
        Wrong{{"--hidden", "129"}, "--hidden: found 129"},
        Wrong{{"--step", "0"}, "--step: found 0"}, Wrong{{"--step", "1"}, "--step: found 1"},
        Wrong{{"--seed", "-1"}, "--seed: found -1"},
        Wrong{{"--seed", "4294967296"}, "--seed: found 4294967296"},
        Wrong{{"--scalar", "half"}, "{float,double}"},
        Wrong{{"--dead-zone", "wide"}, "{continuous,discontinuous}"},
        Wrong{{"--fault", "none", "--rho", "1"}, "--rho: found --fault none"},
        Wrong{{"--fault", "nonlinear", "--mass-loss", "0.5"}, "--mass-loss: found --fault"},
        Wrong{{"--sweep", "--fault", "nonlinear"}, "--sweep: found --fault nonlinear"},
        Wrong{{"--sweep", "--mass-loss", "0.5"}, "--sweep: found --mass-loss"},
        Wrong{{"--sweep", "--accommodate"}, "--sweep: found --accommodate"},
        Wrong{{"--sweep", "--report", "x.html"}, "--sweep: found --report"},
        Wrong{{"--against", "x.toml"}, "--against: found no --sweep"},
        Wrong{{"--log", "x.csv"}, "--log: found no --fault"},
        Wrong{{"--fault", "none", "--force"}, "--force: found no --log or --report"},
        Wrong{{"--fault", "none", "--duration", "0"}, "--duration: found 0"},
        Wrong{{"--fault", "none", "--start", "-1"}, "--start: found -1"},
        Wrong{{"--fault", "none", "--log", "/nowhere/x.csv"}, "/nowhere/x.csv"},
        Wrong{{"--robot", "/nowhere/robot.toml"}, "/nowhere/robot.toml"},
        Wrong{{"--fault", "none", "--report", "/nowhere/x.html"}, "/nowhere/x.html"}));

}  // namespace
}  // namespace offnominal::desk
