#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::bench {

// One long recording of a seven-joint arm, to see what `explain` costs at that size.
struct ScaleRequest {
  Eigen::Index samples = 1'000'000;  // at 1 kHz
  std::uint64_t seed = 1;
  int threads = 1;
};

// The arm of seven_joint_arm.toml as the analysis is given it.
desk::RobotDescription scale_robot();

// It moves along sums of sines, six of every joint, and hides Coulomb friction on joint 4 and a
// ripple of 11 periods per turn on joint 2. Torques are the core's inverse dynamics, plus noise of
// 0.2 % of each joint's largest; positions are rounded to the encoder's counts.
desk::Log scale_recording(const desk::RobotDescription& robot, const ScaleRequest& request);

struct ScaleOutcome {
  std::string verdict;
  std::vector<std::string> found;  // "effect of joint N"
  double wall_s = 0;
  double cpu_s = 0;         // of all threads
  double peak_gib = 0;      // of the whole program, the recording included
  std::string explanation;  // the JSON of `explain`
};

ScaleOutcome run_scale(const ScaleRequest& request);

std::string text_of(const ScaleRequest& request, const ScaleOutcome& outcome);
nlohmann::ordered_json json_of(const ScaleRequest& request, const ScaleOutcome& outcome);

// Robot file and recording as files  in a new folder, for `offnominal explain` itself.
void write_scale(const ScaleRequest& request, const std::filesystem::path& folder);

}  // namespace offnominal::bench
