#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

#include "desk/explain/serial_arm.hpp"
#include "desk/support/run_command.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"

// `offnominal identify` as a user runs it.

namespace offnominal::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using Words = std::vector<std::string>;

class IdentifyVerb : public testing::Test {
 protected:
  void SetUp() override {
    desk::RobotDescription robot = serial_arm(2);
    log_ = record(robot, {.duration_s = 14, .rate_hz = 100});
    write_log(log_);
    robot.effects.clear();
    for (desk::RobotJoint& one : robot.joints) one.joint.mass_kg *= 1.3;
    put(folder_ / "r.toml", desk::robot_text(robot));
  }
  void write_log(const desk::Log& log) const {
    std::string csv = "t,q1,q2,dq1,dq2,tau1,tau2\n";
    for (Eigen::Index i = 0; i < log.t_s.size(); ++i) {
      csv += std::to_string(log.t_s[i]);
      for (const Eigen::MatrixXd* one : {&log.q, &log.dq, &log.tau}) {
        for (Eigen::Index joint = 0; joint < 2; ++joint) {
          csv += "," + std::to_string((*one)(i, joint));
        }
      }
      csv += "\n";
    }
    put(folder_ / "log.csv", csv);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  CommandResult identify(Words more) const {
    more.insert(more.begin(), {"identify", path("log.csv")});
    return run_command(command_file(), more);
  }
  CommandResult identify_file(const std::string& robot, Words more) const {
    more.insert(more.end(), {"--robot", path(robot)});
    return identify(std::move(more));
  }

  TemporaryFolder folder_;
  desk::Log log_;
};

TEST_F(IdentifyVerb, WritesARobotFileThatSaysWhereItIsFrom) {
  const CommandResult result = identify_file("r.toml", {"-o", path("out.toml")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("base parameters: "), HasSubstr("condition number"),
                                HasSubstr("joint 1, held-out parts"), HasSubstr("written: ")));
  const std::string text = content_of(folder_ / "out.toml");
  EXPECT_THAT(text, AllOf(testing::StartsWith("# Identified by `offnominal identify` from"),
                          HasSubstr("# Relative error, fitted recordings:"), HasSubstr("before, "),
                          HasSubstr("kind = \"coulomb_friction\"")));
  const desk::RobotDescription robot = desk::read_robot_file(folder_ / "out.toml");
  EXPECT_EQ(robot.joints.size(), 2U);
  const CommandResult compared = run_command(
      command_file(), {"compare", path("log.csv"), "--robot", path("out.toml"), "--json"});
  const CommandResult again = identify_file("r.toml", {"-o", path("again.toml"), "--json"});
  // The error that is told is the one that compare gives of the file.
  const json one = json::parse(compared.out);
  const json told = json::parse(again.out);
  for (std::size_t joint = 0; joint < 2; ++joint) {
    EXPECT_NEAR(one["joints"][joint]["rms_error"].get<double>(),
                told["joints"][joint]["after"]["fit"]["rms_error"].get<double>(), 1e-9);
  }
}

TEST_F(IdentifyVerb, HasItsNumbersInJsonAndOnAPage) {
  const CommandResult result =
      identify_file("r.toml", {"-o", path("out.toml"), "--json", "--report", path("page.html")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json told = json::parse(result.out);
  EXPECT_EQ(told["links"].size(), 2U);
  EXPECT_EQ(told["links"][0]["mass"]["unit"], "kg");
  EXPECT_GT(told["base_parameters"].size(), 5U);
  EXPECT_GT(told["determined"].get<int>(), 3);
  EXPECT_GT(told["condition_number"].get<double>(), 1);
  EXPECT_TRUE(told["payload"].is_null());
  EXPECT_EQ(told["written"], path("out.toml"));
  EXPECT_TRUE(told["data_faults"].is_array());
  EXPECT_LT(told["joints"][0]["after"]["holdout"]["relative_error_percent"].get<double>(),
            told["joints"][0]["before"]["holdout"]["relative_error_percent"].get<double>());
  EXPECT_THAT(content_of(folder_ / "page.html"), HasSubstr("Base parameters"));
}

// A torque that nothing which is fitted follows: the file is better than before, and still no
// model.
TEST_F(IdentifyVerb, SaysOfWhichJointMostIsStillMissed) {
  const CommandResult usual = identify_file("r.toml", {"--json"});
  EXPECT_THAT(usual.out, testing::Not(HasSubstr("most is still missed")));
  desk::Log pushed = log_;
  std::mt19937 generator(7);
  std::normal_distribution<double> size(0, 3 * pushed.tau.col(1).cwiseAbs().maxCoeff());
  double push = 0;
  for (Eigen::Index i = 0; i < pushed.tau.rows(); ++i) {
    if (i % 40 == 0) push = size(generator);
    pushed.tau(i, 1) += push;
  }
  write_log(pushed);
  Words options = {"-o", path("out.toml"), "--force"};
  for (const char* reason : {"torque_unit", "torque_sign", "joint_order", "clock_skew", "jump"}) {
    options.insert(options.end(), {"--keep", std::string("all:") + reason});
  }
  const CommandResult result = identify_file("r.toml", options);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("Of the torque of joint 2 most is still missed")) << result.out;
  EXPECT_THAT(result.out, HasSubstr("`offnominal explain` says what else acts on it"));
}

// What it writes would pass every check but this one: links of a tenth are no error of a drawing.
TEST_F(IdentifyVerb, DoubtsLinksThatAreTenTimesOffTheirFile) {
  desk::RobotDescription light = desk::read_robot_file(folder_ / "r.toml");
  for (desk::RobotJoint& one : light.joints) {
    one.joint.mass_kg /= 30;
    for (double& inertia : one.joint.inertia_kg_m2) inertia /= 30;
  }
  put(folder_ / "light.toml", desk::robot_text(light));
  const Words kept = {"--keep", "all:torque_unit", "-o", path("out.toml")};
  const CommandResult refused = identify_file("light.toml", kept);
  EXPECT_EQ(refused.exit_code, 1) << refused.err;
  EXPECT_THAT(refused.out, AllOf(HasSubstr("link 2 would have "), HasSubstr("[channels]"),
                                 HasSubstr("--from-geometry")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.toml"));
  Words forced = kept;
  forced.emplace_back("--force");
  EXPECT_EQ(identify_file("light.toml", forced).exit_code, 0);
  Words geometry = kept;
  geometry.emplace_back("--from-geometry");
  geometry[3] = path("geometry.toml");
  EXPECT_EQ(identify_file("light.toml", geometry).exit_code, 0);
}

TEST_F(IdentifyVerb, ReadsLinksThatAreBlanks) {
  std::string text = content_of(folder_ / "r.toml");
  for (const char* key : {"mass_kg", "centre_of_mass_m", "inertia_kg_m2"}) {
    for (std::size_t at = text.find(key); at != std::string::npos;
         at = text.find(key, at + 4 + std::string(key).size())) {
      text.replace(at, 0, "# ");
    }
  }
  put(folder_ / "blank.toml", text);
  const CommandResult result = identify_file("blank.toml", {"-o", path("out.toml"), "--json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json told = json::parse(result.out);
  EXPECT_TRUE(told["links"][0]["mass"]["before"].is_null());
  EXPECT_TRUE(told["joints"][0]["before"]["fit"]["rms_error"].is_null());
  EXPECT_LT(told["joints"][1]["after"]["fit"]["relative_error_percent"].get<double>(), 5);
  EXPECT_NO_THROW(static_cast<void>(desk::read_robot_file(folder_ / "out.toml")));
  // Every other verb asks for them still.
  EXPECT_EQ(run_command(command_file(), {"compare", path("log.csv"), "--robot", path("blank.toml")})
                .exit_code,
            2);
}

TEST_F(IdentifyVerb, AnswersWhatTheLastLinkCarriesWithoutAFileToWrite) {
  const CommandResult result = identify_file("r.toml", {"--find-payload", "--json", "--force"});
  const json told = json::parse(result.out);
  EXPECT_TRUE(told["payload"]["mass"].is_object());
  EXPECT_EQ(told["payload"]["place"].size(), 3U);
  EXPECT_TRUE(told["written"].is_null());
}

TEST_F(IdentifyVerb, RefusesWhatDoesNotBelongTogetherInOneLine) {
  const auto expect_refusal = [&](const CommandResult& result, const std::string& words) {
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr(words));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  };
  expect_refusal(identify_file("r.toml", {}), "add -o");
  expect_refusal(identify_file("r.toml", {"--find-payload", "--from-geometry"}), "--from-geometry");
  put(folder_ / "there.toml", "somebody's work");
  expect_refusal(identify_file("r.toml", {"-o", path("there.toml")}), "which is there already");
  EXPECT_EQ(content_of(folder_ / "there.toml"), "somebody's work");
}

TEST_F(IdentifyVerb, WritesNothingWhereNothingIsDetermined) {
  std::string csv = "t,q1,q2,tau1,tau2\n";
  for (int i = 0; i < 500; ++i) {
    csv += std::to_string(0.01 * i) + ",0.1,0.2," + std::to_string(1 + 0.01 * (i % 7)) + ",2\n";
  }
  put(folder_ / "log.csv", csv);
  const CommandResult result = identify_file("r.toml", {"-o", path("out.toml"), "--force"});
  EXPECT_NE(result.exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.toml"));
}

}  // namespace
}  // namespace offnominal::test
