#pragma once

#include <memory>
#include <string>

#include "desk/compare/recorded_arm.hpp"
#include "robot/robot_file.hpp"
#include "studio/workbench.hpp"

namespace offnominal::test {

// The two-link arm with Coulomb and viscous friction on its second joint that its file lacks, and a
// second recording of it, in another motion. `robot_file` is written.
inline desk::studio::Input studio_input(const std::filesystem::path& robot_file, bool hold_out) {
  const auto friction = [](const ArmInstant& at) {
    return Eigen::Vector2d(0, 0.8 * at.dq[1] + 1.5 * std::tanh(at.dq[1] / 0.01));
  };
  const auto record = [&](double amplitude, std::uint64_t seed) {
    return record_arm({.duration_s = 12,
                       .rate_hz = 250,
                       .torque_noise = 0.05,
                       .seed = seed,
                       .amplitude = amplitude},
                      friction);
  };
  desk::write_robot_file(arm_description(), robot_file, desk::Existing::kReplace);
  desk::Treated recordings;
  recordings.logs.push_back(record(1, 1));
  recordings.logs[0].file = "fitted.csv";
  if (hold_out) {
    recordings.holdout.push_back(record(0.7, 2));
    recordings.holdout[0].file = "held_out.csv";
  }
  desk::studio::Input input;
  input.robot = desk::read_robot_file(robot_file);
  input.robot_file = robot_file.string();
  input.recordings = std::make_shared<const desk::Treated>(std::move(recordings));
  input.log_files = {"fitted.csv"};
  if (hold_out) input.holdout_files = {"held_out.csv"};
  input.source = "Fitted to fitted.csv by offnominal add.";
  return input;
}

}  // namespace offnominal::test
