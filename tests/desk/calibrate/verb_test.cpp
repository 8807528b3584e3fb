#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/compare/recorded_arm.hpp"
#include "desk/support/run_command.hpp"
#include "log/csv_text.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

// `offnominal calibrate` as a user runs it.

namespace {

using namespace offnominal::desk;
using nlohmann::json;
using offnominal::test::arm_description;
using offnominal::test::ArmInstant;
using offnominal::test::CommandResult;
using offnominal::test::content_of;
using offnominal::test::record_arm;
using testing::HasSubstr;
using testing::Not;

class CalibrateVerb : public testing::Test {
 protected:
  void SetUp() override {
    write_log("a.csv", 1, 0);
    write_log("b.csv", 2, 0);
    write_log("broken.csv", 3, 20);
    RobotDescription robot = arm_description();
    robot.bound.emplace().constant.value = 50;
    offnominal::test::put(folder_ / "arm.toml", "# a comment that stays\n" + robot_text(robot));
  }

  void write_log(const std::string& name, std::uint64_t seed, double fault_nm) {
    const Log log =
        record_arm({.duration_s = 20, .rate_hz = 200, .torque_noise = 0.5, .seed = seed},
                   [fault_nm](const ArmInstant& at) -> Eigen::Vector2d {
                     return {at.t_s > 10 ? fault_nm : 0, 0};
                   });
    offnominal::test::put(folder_ / name, csv_text(log));
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }

  CommandResult calibrate(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "calibrate");
    return offnominal::test::run_command(offnominal::test::command_file(), std::move(arguments));
  }

  offnominal::test::TemporaryFolder folder_;
};

TEST_F(CalibrateVerb, WritesARobotFileThatReplaysWithoutAlarm) {
  const CommandResult result =
      calibrate({path("a.csv"), "--holdout", path("b.csv"), "--robot", path("arm.toml"), "-o",
                 path("new.toml"), "--report", path("page.html")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("0 alarms in 20 s"));
  EXPECT_THAT(result.out, HasSubstr("written: " + path("new.toml")));
  const std::string text = content_of(path("new.toml"));
  EXPECT_THAT(text, HasSubstr("# a comment that stays"));
  EXPECT_THAT(text, HasSubstr("Calibrated by offnominal calibrate on a.csv."));
  EXPECT_THAT(content_of(path("page.html")), HasSubstr("offnominal calibrate"));
  const CommandResult replayed = offnominal::test::run_command(
      offnominal::test::command_file(),
      {"replay", path("b.csv"), "--robot", path("new.toml"), "--check"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out;
}

TEST_F(CalibrateVerb, JsonIsOneObjectAndTheSameEveryTime) {
  const std::vector<std::string> arguments{path("a.csv"),    path("b.csv"), "--robot",
                                           path("arm.toml"), "-o",          path("new.toml"),
                                           "--json",         "--force"};
  const CommandResult first = calibrate(arguments);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const std::string file = content_of(path("new.toml"));
  const CommandResult second = calibrate(arguments);
  EXPECT_EQ(first.out, second.out);
  EXPECT_EQ(content_of(path("new.toml")), file);
  const json result = json::parse(first.out);
  EXPECT_EQ(result["old_bound"]["value"], 50);
  EXPECT_EQ(result["output"], path("new.toml"));
  EXPECT_LT(result["mean_threshold_after"].get<double>(),
            result["mean_threshold_before"].get<double>());
  EXPECT_EQ(result["false_alarms"]["alarms_per_hour"], 0.1);
}

TEST_F(CalibrateVerb, AFaultInTheHoldOutEndsInOneAndNothingIsWritten) {
  const CommandResult result = calibrate({path("a.csv"), "--holdout", path("broken.csv"), "--robot",
                                          path("arm.toml"), "-o", path("new.toml")});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.out, HasSubstr("not written: "));
  EXPECT_FALSE(std::filesystem::exists(path("new.toml")));
}

TEST_F(CalibrateVerb, RefusesAVelocityErrorInTorqueSpaceBeforeItReadsARecording) {
  RobotDescription robot = arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  offnominal::test::put(folder_ / "torque.toml", robot_text(robot));
  const CommandResult result = calibrate({path("nowhere.csv"), "--robot", path("torque.toml"), "-o",
                                          path("new.toml"), "--velocity-error", "0.1"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("offnominal calibrate: --velocity-error: found 0.1"));
  EXPECT_THAT(result.err, HasSubstr("in " + path("torque.toml")));
}

TEST_F(CalibrateVerb, WritesTheSecondLevelThatIsAskedForAndSaysWhereItIsGone) {
  RobotDescription robot = arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  robot.estimator.fast_alpha = 5 * robot.estimator.alpha;
  offnominal::test::put(folder_ / "torque.toml", robot_text(robot));
  const auto calibrated = [&](const std::string& from, const std::string& to,
                              std::vector<std::string> more) {
    std::vector<std::string> arguments{path("a.csv"), path("b.csv"), "--robot",
                                       path(from),    "-o",          path(to)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return calibrate(arguments);
  };
  const CommandResult asked =
      calibrated("torque.toml", "levels.toml", {"--act-alarms-per-hour", "1e-5"});
  ASSERT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_THAT(asked.out, HasSubstr("act at: the second level, for 1e-05 false alarms per hour"));
  EXPECT_THAT(content_of(path("levels.toml")), HasSubstr("act_ratio = ["));
  const CommandResult again = calibrated("levels.toml", "again.toml", {});
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("had a second level (act_ratio), the new one has none"));
  EXPECT_THAT(content_of(path("again.toml")), Not(HasSubstr("act_ratio")));
  const CommandResult refused =
      calibrated("arm.toml", "no.toml", {"--act-alarms-per-hour", "0.001"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("two levels are of joints that are judged one by one"));
}

TEST_F(CalibrateVerb, ReplayOfATorqueSpaceSaysNoMaximaOverJoints) {
  RobotDescription robot = arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  robot.bound.emplace().kind = BoundSettings::Kind::kPerJoint;
  robot.bound->joints.assign(2, {});
  offnominal::test::put(folder_ / "torque.toml", robot_text(robot));
  const auto replayed = [&](const std::string& file) {
    return offnominal::test::run_command(offnominal::test::command_file(),
                                         {"replay", path("a.csv"), "--robot", path(file)});
  };
  const CommandResult joint_by_joint = replayed("torque.toml");
  EXPECT_EQ(joint_by_joint.exit_code, 0) << joint_by_joint.err;
  EXPECT_THAT(joint_by_joint.out, HasSubstr("largest residual / threshold"));
  EXPECT_THAT(joint_by_joint.out, Not(HasSubstr("|e|")));
  EXPECT_THAT(joint_by_joint.out, Not(HasSubstr("largest threshold mu")));
  EXPECT_THAT(replayed("arm.toml").out, HasSubstr("largest threshold mu"));
}

TEST_F(CalibrateVerb, SaysWhereTheCommentsOfTheRobotFileAreLost) {
  const std::string text = content_of(path("arm.toml"));
  const auto bound = text.find("[uncertainty_bound]");
  const std::string head = text.substr(0, bound);
  offnominal::test::put(folder_ / "one_line.toml",
                        "# a comment that stays\nuncertainty_bound = {kind = \"constant\", value = "
                        "50.0}\n" +
                            head.substr(head.find("format")));
  offnominal::test::put(folder_ / "quoted.toml",
                        head + "[\"uncertainty_bound\"]\nkind = \"constant\"\nvalue = 50.0\n");
  const auto written = [&](const std::string& robot) {
    const CommandResult result =
        calibrate({path("a.csv"), "--robot", path(robot), "-o", path("new.toml"), "--force"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result;
  };
  EXPECT_THAT(written("one_line.toml").err, Not(HasSubstr("comments")));
  EXPECT_THAT(content_of(path("new.toml")), HasSubstr("# a comment that stays\n"));
  EXPECT_THAT(written("quoted.toml").err,
              HasSubstr("hint: " + path("new.toml") + " has none of the comments of"));
}

// Single bad rows: each costs itself alone, and cuts the recording all the same.
void spoil(Log& log, double first_s, double every_s) {
  const auto rows = [&](double seconds) {
    return static_cast<Eigen::Index>(seconds / log.period_s);
  };
  for (Eigen::Index row = rows(first_s); row < log.sample_count(); row += rows(every_s)) {
    log.tau(row, 0) += 400;
  }
}

TEST_F(CalibrateVerb, SaysWhatWasCutOutWhereTheRestIsTooShort) {
  const auto told = [&](double first_s) {
    Log log = record_arm({.duration_s = 20, .rate_hz = 200, .torque_noise = 0.5});
    spoil(log, first_s, 1.5);
    offnominal::test::put(folder_ / "cut.csv", csv_text(log));
    const CommandResult result =
        calibrate({path("cut.csv"), "--robot", path("arm.toml"), "-o", path("new.toml")});
    EXPECT_EQ(result.exit_code, 2);
    return result.err;
  };
  EXPECT_THAT(told(1.5), HasSubstr("13 stretches left out, and no 2 s between what is left out"));
  const std::string few = told(3.0);
  EXPECT_THAT(few, HasSubstr("whole blocks of 1 s to calibrate on, in "));
  EXPECT_THAT(few, HasSubstr("; of 20"));
  EXPECT_THAT(few, HasSubstr("12 rows of jump in 12 stretches"));
  EXPECT_THAT(few, HasSubstr("say with --keep JOINT:REASON what is no fault"));
}

TEST_F(CalibrateVerb, TakesOneReasonToKeepAtATime) {
  const CommandResult help = calibrate({"--help"});
  EXPECT_THAT(help.out, HasSubstr("--keep JOINT:REASON "));
  EXPECT_THAT(help.out, Not(HasSubstr("--keep JOINT:REASON ...")));
  const CommandResult result =
      calibrate({"--keep", "all:jump", "--keep", "1:stuck", path("a.csv"), path("b.csv"), "--robot",
                 path("arm.toml"), "-o", path("new.toml")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(CalibrateVerb, RefusesWithOneLineAndExitTwo) {
  offnominal::test::put(folder_ / "short.csv", "t,q1,q2,tau1,tau2\n0,1,2,3,4\n");
  offnominal::test::put(folder_ / "there.toml", "");
  const std::string out = path("new.toml");
  const std::string robot = path("arm.toml");
  struct Wrong {
    std::vector<std::string> arguments;
    std::string told;
  };
  const std::vector<Wrong> all{
      {{path("a.csv"), "--robot", robot, "-o", path("there.toml")}, "there already"},
      {{path("a.csv"), "--robot", robot, "-o", path("a.csv"), "--force"}, "which is that of LOG"},
      {{path("a.csv"), path("a.csv"), "--robot", robot, "-o", out}, "the same as"},
      {{path("a.csv"), "--holdout", path("a.csv"), "--robot", robot, "-o", out}, "the same as"},
      {{path("short.csv"), "--robot", robot, "-o", out}, "short.csv"},
      {{path("nowhere.csv"), "--robot", robot, "-o", out}, "nowhere.csv"},
      {{path("a.csv"), "--robot", robot, "-o", out, "--alarms-per-hour", "0"}, "1e-6 to 60"},
      {{path("a.csv"), "--robot", robot, "-o", out, "--velocity-error", "-1"}, "at least 0"},
      {{path("a.csv"), "--robot", robot, "-o", "/nowhere/new.toml"}, "/nowhere/new.toml"},
      {{path("a.csv"), "--robot", robot, "-o", out, "--period", "0"}, "--period: 0 is no number"},
      {{path("a.csv"), "--robot", (offnominal::test::kRobots / "emps.toml").string(), "-o", out},
       "a.csv"}};
  for (const Wrong& wrong : all) {
    const CommandResult result = calibrate(wrong.arguments);
    EXPECT_EQ(result.exit_code, 2) << wrong.told;
    EXPECT_EQ(result.out, "") << wrong.told;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(wrong.told));
    EXPECT_FALSE(std::filesystem::exists(out)) << wrong.told;
  }
}

}  // namespace
