#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/compare/recorded_arm.hpp"
#include "desk/support/run_command.hpp"
#include "log/csv_text.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"
#include "support/robots.hpp"

// `offnominal tune` as a user runs it.

namespace {

using namespace offnominal::desk;
using nlohmann::json;
using offnominal::test::ArmInstant;
using offnominal::test::CommandResult;
using offnominal::test::content_of;
using testing::HasSubstr;
using testing::Not;

class TuneVerb : public testing::Test {
 protected:
  void SetUp() override {
    for (const std::uint64_t seed : {1U, 2U}) {
      const Log log = offnominal::test::record_arm(
          {.duration_s = 15, .rate_hz = 100, .torque_noise = 0.1, .seed = seed},
          [](const ArmInstant& at) -> Eigen::Vector2d {
            return {0.2 * std::tanh(20 * at.dq[0]), 0.1 * std::tanh(20 * at.dq[1])};
          });
      offnominal::test::put(folder_ / (std::to_string(seed) + ".csv"), csv_text(log));
    }
    RobotDescription robot = offnominal::test::arm_description();
    robot.bound.emplace().constant.value = 50;
    offnominal::test::put(folder_ / "arm.toml", "# a comment that stays\n" + robot_text(robot));
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_ / name).string();
  }
  CommandResult run(std::vector<std::string> arguments) {
    return offnominal::test::run_command(offnominal::test::command_file(), std::move(arguments));
  }
  CommandResult tune(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{
        "tune",           path("1.csv"), path("2.csv"),     "--robot",
        path("arm.toml"), "-o",          path("tuned.toml")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  offnominal::test::TemporaryFolder folder_;
};

TEST_F(TuneVerb, TakesAFileToAMonitorWithCalibrateAndReplay) {
  const CommandResult tuned = tune({});
  ASSERT_EQ(tuned.exit_code, 0) << tuned.err;
  EXPECT_THAT(tuned.out, HasSubstr("written: " + path("tuned.toml")));
  EXPECT_THAT(tuned.out, HasSubstr("Next: `offnominal calibrate`"));
  const std::string text = content_of(path("tuned.toml"));
  EXPECT_THAT(text, HasSubstr("# a comment that stays"));
  EXPECT_THAT(text, HasSubstr("space = \"torque\"  # joint by joint"));
  EXPECT_THAT(text, Not(HasSubstr("[uncertainty_bound]")));
  const CommandResult calibrated = run({"calibrate", path("1.csv"), path("2.csv"), "--robot",
                                        path("tuned.toml"), "-o", path("watched.toml")});
  ASSERT_EQ(calibrated.exit_code, 0) << calibrated.err;
  const CommandResult replayed =
      run({"replay", path("2.csv"), "--robot", path("watched.toml"), "--check"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out;
}

TEST_F(TuneVerb, JsonHoldsEveryTrial) {
  const CommandResult result = tune({"--json", "--within", "0.5"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json answer = json::parse(result.out);
  EXPECT_EQ(answer["within_s"], 0.5);
  EXPECT_EQ(answer["alphas"].size(), 8U);
  EXPECT_EQ(answer["estimator"][0]["key"], "space");
  EXPECT_GT(answer["before"]["missed"], 0);
}

TEST_F(TuneVerb, RefusesWhatItCannotDoAndWritesNothing) {
  const CommandResult fast = tune({"--within", "0"});
  EXPECT_EQ(fast.exit_code, 2);
  EXPECT_THAT(fast.err, HasSubstr("--within"));
  EXPECT_THAT(fast.err, HasSubstr("0.005 to 10 s"));
  EXPECT_FALSE(std::filesystem::exists(path("tuned.toml")));
  offnominal::test::put(folder_ / "tuned.toml", "mine\n");
  EXPECT_EQ(tune({}).exit_code, 2);
  EXPECT_EQ(content_of(path("tuned.toml")), "mine\n");
}

}  // namespace
