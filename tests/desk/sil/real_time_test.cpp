// `offnominal sil --real-time`: two programs on a bus of the kernel.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <net/if.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desk/sil/serial_robot.hpp"
#include "desk/support/run_command.hpp"
#include "support/places.hpp"

namespace offnominal::desk::sil {
namespace {

using nlohmann::json;
using test::content_of;
using test::put;
using test::run_command;
using test::TemporaryFolder;
using testing::HasSubstr;

class RealTime : public testing::Test {
 protected:
  test::CommandResult run(const std::string& scenario, std::vector<std::string> more = {}) {
    put(folder_ / "scenario.toml", "format = 1\nduration_s = 1.0\n" + scenario);
    std::vector<std::string> words = {"sil", "--real-time", "--scenario", folder_ / "scenario.toml",
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    if (std::find(words.begin(), words.end(), "--bus") == words.end()) {
      words.insert(words.end(), {"--bus", "vcan0"});
    }
    return run_command(test::command_file(), words);
  }

  // With a robot file whose joint falls silent at 1.5 s of 2.
  void run_until_silent(const std::string& robot, int joint) {
    put(folder_ / "robot.toml", robot);
    const auto result = run(
        "[[fault]]\nkind = \"silent_node\"\nbegin_s = 1.5\njoint = " + std::to_string(joint) + "\n",
        {"--robot", folder_ / "robot.toml", "--duration", "2", "--candump", folder_ / "run.log",
         "--force"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const json run = json::parse(result.out);
    EXPECT_EQ(run.at("controller_fault"), "EncoderSilent") << run.dump(2);
    EXPECT_TRUE(run.at("detection_time_s").is_null());
    EXPECT_GT(run.at("ended_early_s").get<double>(), 1.4);
    EXPECT_LT(run.at("max_error_to_threshold_before_fault").get<double>(), 0.9);
  }

  TemporaryFolder folder_;
};

// OFFNOMINAL_SECONDS: how long.
TEST_F(RealTime, KeepsItsMillisecondAndGivesWhatLockStepGives) {
  const char* wished = std::getenv("OFFNOMINAL_SECONDS");
  const int seconds = wished != nullptr ? std::max(1, std::atoi(wished)) : 2;
  const auto result =
      run("", {"--duration", std::to_string(seconds), "--candump", folder_ / "run.log", "--force"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json run = json::parse(result.out);
  std::cout << run.at("real_time").dump() << ", " << run.at("overruns") << " late ticks\n";
  EXPECT_EQ(run.at("controller_state"), "armed") << run.dump(2);
  EXPECT_TRUE(run.at("detection_time_s").is_null());
  EXPECT_TRUE(run.at("time_to_safe_state_s").is_null());
  EXPECT_GE(run.at("real_time").at("ticks").get<int>(), 1000 * seconds);
  // Printed, and usually 0; what waits for a file of this host may be late once.
  EXPECT_LT(run.at("overruns").get<int>(), 10 * seconds);
  EXPECT_LT(run.at("real_time").at("plant_overruns").get<int>(), 10 * seconds);
  EXPECT_EQ(run.at("bus").at("rejected"), 0);
  EXPECT_EQ(run.at("bus").at("lost"), 0);
  EXPECT_LT(run.at("tracking_rms_rad").get<double>(), 0.1);
  const std::string frames = content_of(folder_ / "run.log");
  // Per tick two readings, two statuses and two commands.
  EXPECT_GT(std::count(frames.begin(), frames.end(), '\n'), 6 * 1000 * seconds);
}

TEST_F(RealTime, AnEncoderThatDropsOutLeadsToTheSafeState) {
  const auto result = run("[[fault]]\nkind = \"encoder_dropout\"\nbegin_s = 0.5\njoint = 2\n");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json run = json::parse(result.out);
  EXPECT_EQ(run.at("controller_state"), "fault");
  EXPECT_EQ(run.at("controller_fault"), "DriveReported");
  EXPECT_GT(run.at("time_to_safe_state_s").get<double>(), 0.0);
  EXPECT_LT(run.at("time_to_safe_state_s").get<double>(), 0.05);
  EXPECT_LT(run.at("ended_early_s").get<double>(), 1.0);
}

// A robot file of six joints at both ends: CAN FD without being asked for it.
TEST_F(RealTime, RunsARobotFileOfSixJoints) {
  // Too much for classic CAN, and not too much for the machine of ./dev vcan.
  const std::string text = test::serial_robot_text(6);
  const std::string period = "period_s = 0.001";
  run_until_silent(std::string(text).replace(text.find(period), period.size(), "period_s = 0.002"),
                   6);
  // Readings of six joints in one frame of 48 bytes; candump writes CAN FD with "##".
  EXPECT_NE(content_of(folder_ / "run.log").find("1A0##"), std::string::npos);
}

// Which joint it was comes with the controller's recording.
TEST_F(RealTime, NamesTheJointThatIsOffNominal) {
  put(folder_ / "robot.toml", test::by_joint_robot_text(2, 2.0));
  const auto result =
      run("[[fault]]\nkind = \"disturbance_torque\"\nbegin_s = 1.0\njoint = 2\nsize = 10\n",
          {"--robot", folder_ / "robot.toml", "--duration", "2", "--candump", folder_ / "run.log",
           "--force"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json run = json::parse(result.out);
  EXPECT_EQ(run.at("first_joint"), 2) << run.dump(2);
  ASSERT_EQ(run.at("joints").size(), 2U);
  EXPECT_EQ(run.at("joints")[1].at("detection_time_s"), run.at("detection_time_s"));
  EXPECT_NE(content_of(folder_ / "run.log").find(" 73F#"), std::string::npos);
}

// Both programs take the drives' protocol from the robot's file.
TEST_F(RealTime, RunsARobotFileWithOdrives) {
  run_until_silent(test::odrive_robot_text(2, 2, "0.6"), 2);
  // Node 60: Get_Encoder_Estimates, and Set_Input_Torque.
  const std::string frames = content_of(folder_ / "run.log");
  EXPECT_NE(frames.find(" 789#"), std::string::npos);
  EXPECT_NE(frames.find(" 78E#"), std::string::npos);
}

TEST_F(RealTime, MakesAVirtualBusAndRemovesIt) {
  ASSERT_EQ(::if_nametoindex("vcan8"), 0U);
  const auto result = run("", {"--bus", "vcan8", "--duration", "0.5"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(::if_nametoindex("vcan8"), 0U);
}

TEST_F(RealTime, RefusesWhatItCannotDo) {
  const auto in_process = run("", {"--bus", "in-process"});
  EXPECT_EQ(in_process.exit_code, 2);
  EXPECT_THAT(in_process.err, HasSubstr("--bus vcan0"));
  const auto bus_off = run("[[fault]]\nkind = \"bus_off\"\nbegin_s = 0.5\n");
  EXPECT_EQ(bus_off.exit_code, 2);
  EXPECT_THAT(bus_off.err, HasSubstr("lock-step"));
  const auto none = run("", {"--bus", "can9"});
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("can9"));
}

}  // namespace
}  // namespace offnominal::desk::sil
