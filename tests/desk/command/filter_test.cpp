#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "../compare/recorded_arm.hpp"
#include "desk/support/run_command.hpp"
#include "log/csv_text.hpp"
#include "robot/robot_file.hpp"
#include "support/places.hpp"

// One filter for every verb that analyses a recording, and one for those that run the monitor on
// it: each says which, and what it follows from.

namespace offnominal::desk {
namespace {

using test::CommandResult;
using testing::AllOf;
using testing::HasSubstr;
using Words = std::vector<std::string>;

class FilterOfVerbs : public testing::Test {
 protected:
  void SetUp() override {
    test::put(folder_ / "arm.csv",
              csv_text(test::record_arm({.duration_s = 30, .rate_hz = 250, .torque_noise = 0.05})));
    RobotDescription robot = test::arm_description();
    robot.joints[1].encoder.counts_per_unit = 4096 / (2 * std::numbers::pi);
    BoundSettings bound;
    bound.kind = BoundSettings::Kind::kConstant;
    bound.constant.value = 20;
    robot.bound = bound;
    robot.estimator.alpha = 20;
    write_robot_file(robot, folder_ / "coarse.toml");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  CommandResult run(Words words, const Words& more = {}) const {
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--robot", path("coarse.toml")});
    return test::run_command(test::command_file(), std::move(words));
  }
  Words writing(Words words) const {
    words.insert(words.end(), {"-o", path("new.toml"), "--force"});
    return words;
  }
  std::vector<Words> analyses() const {
    const std::string log = path("arm.csv");
    return {{"compare", log},
            {"explain", log, "--replays", "0"},
            writing({"identify", log}),
            writing({"add", "viscous_friction", "--joint", "1", "--log", log}),
            writing({"add", "--all-found", "--log", log})};
  }
  nlohmann::json filter_of(const Words& verb, const Words& more = {}) const {
    Words all = more;
    all.emplace_back("--json");
    const CommandResult result = run(verb, all);
    EXPECT_NE(result.exit_code, 2) << result.err;
    return nlohmann::json::parse(result.out).at("filter");
  }

  test::TemporaryFolder folder_;
};

TEST_F(FilterOfVerbs, IsTheSameInEveryAnalysisAndSaysWhatItFollowsFrom) {
  const nlohmann::json first = filter_of({"compare", path("arm.csv")});
  EXPECT_EQ(first.at("cutoff_from"), "encoder");
  EXPECT_EQ(first.at("cutoff_joint"), 2);
  const double cutoff_hz = first.at("torque_cutoff_hz");
  EXPECT_LT(cutoff_hz, 12);
  const std::string words = fmt::format(
      "position low-pass {:.4g} Hz, torque low-pass {:.4g} Hz by the encoder of joint "
      "2, one sample of ",
      2.5 * cutoff_hz, cutoff_hz);
  for (const Words& verb : analyses()) {
    SCOPED_TRACE(verb[0] + " " + verb[1]);
    EXPECT_EQ(filter_of(verb), first);
    EXPECT_THAT(run(verb).out, HasSubstr(words));
  }
}

TEST_F(FilterOfVerbs, IsTheSameAsAskedFor) {
  const std::string log = path("arm.csv");
  const Words asked{"--cutoff", "9", "--decimate", "5"};
  const nlohmann::json first = filter_of({"compare", log}, asked);
  EXPECT_EQ(first.at("cutoff_from"), "--cutoff");
  EXPECT_EQ(first.at("torque_cutoff_hz"), 9);
  EXPECT_EQ(filter_of(writing({"identify", log}), asked), first);
  EXPECT_EQ(filter_of(writing({"add", "viscous_friction", "--joint", "1", "--log", log}), asked),
            first);
  EXPECT_EQ(filter_of({"compare", log}, {"--decimate", "50"}).at("cutoff_from"), "--decimate");
}

TEST_F(FilterOfVerbs, IsTheMonitorsOwnWhereItRuns) {
  const std::string log = path("arm.csv");
  const Words calibrate = writing({"calibrate", log});
  const nlohmann::json replayed = filter_of({"replay", log});
  EXPECT_EQ(replayed.at("cutoff_from"), "alpha_per_s");
  EXPECT_NEAR(replayed.at("cutoff_hz"), 20 / (2 * std::numbers::pi), 1e-9);
  EXPECT_TRUE(replayed.at("velocity_cutoff_hz").is_null());
  EXPECT_EQ(filter_of(calibrate), replayed);
  for (const Words& verb : {Words{"replay", log}, calibrate}) {
    EXPECT_THAT(
        run(verb).out,
        HasSubstr("samples as recorded, the monitor's own filter 3.183 Hz by alpha_per_s\n"));
  }
}

// Velocities that nobody recorded are made of positions, by a low-pass that is said.
TEST_F(FilterOfVerbs, OfDerivedVelocitiesIsSaidToo) {
  test::put(folder_ / "channels.toml",
            "time = \"t\"\nposition = [\"q1\", \"q2\"]\ntorque = [\"tau1\", \"tau2\"]\n");
  const Words more{"--channels", path("channels.toml")};
  const nlohmann::json replayed = filter_of({"replay", path("arm.csv")}, more);
  EXPECT_EQ(replayed.at("velocity_cutoff_hz"), 50);
  EXPECT_THAT(run({"replay", path("arm.csv")}, more).out,
              HasSubstr("; velocities that were not recorded: of positions, low-pass 50 Hz\n"));
}

// What a controller judges that observes its velocities, whatever was recorded; a bound calibrated
// so covers them.
TEST_F(FilterOfVerbs, OfObservedVelocitiesIsTheControllersOwn) {
  const Words observed{"--observe-velocity"};
  const std::string log = path("arm.csv");
  const Words calibrate = writing({"calibrate", log});
  for (const Words& verb : {Words{"replay", log}, calibrate}) {
    EXPECT_TRUE(filter_of(verb, observed).at("observed"));
    EXPECT_FALSE(filter_of(verb).at("observed"));
    EXPECT_THAT(run(verb, observed).out,
                AllOf(HasSubstr("samples as a controller observes them, the monitor's own filter"),
                      HasSubstr("velocities as a controller observes them of positions, two poles "
                                "at 50 rad/s")));
  }
  test::put(folder_ / "channels.toml",
            "time = \"t\"\nposition = [\"q1\", \"q2\"]\ntorque = [\"tau1\", \"tau2\"]\n");
  const Words positions{"--channels", path("channels.toml")};
  static_cast<void>(filter_of(calibrate, positions));
  EXPECT_FALSE(read_robot_file(path("new.toml")).bound->covers_velocities);
  Words both = positions;
  both.insert(both.end(), observed.begin(), observed.end());
  static_cast<void>(filter_of(calibrate, both));
  EXPECT_TRUE(read_robot_file(path("new.toml")).bound->covers_velocities);
}

}  // namespace
}  // namespace offnominal::desk
