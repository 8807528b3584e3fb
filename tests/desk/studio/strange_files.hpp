#pragma once

#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "desk/compare/recorded_arm.hpp"
#include "explain/explain.hpp"
#include "log/csv_text.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"
#include "studio/session_files.hpp"

namespace offnominal::test {

inline desk::Log recorded(double amplitude) {
  return record_arm(
      {.duration_s = 12, .rate_hz = 250, .torque_noise = 0.05, .seed = 1, .amplitude = amplitude});
}

// As a stranger has it: other names, degrees, the torque of joint 2 with the other sign.
inline std::string strange_csv(double amplitude) {
  desk::Log log = recorded(amplitude);
  log.q *= 180 / std::numbers::pi;
  log.tau.col(1) *= -1;
  const std::string text = desk::csv_text(log);
  return "time,actual_pos_1,actual_pos_2,actual_vel_1,actual_vel_2,drive_torque_1,drive_torque_2" +
         text.substr(text.find('\n'));
}

inline std::string robot_text_of_arm() { return desk::robot_text(arm_description()); }

// As the verb opens what its command line names.
inline desk::studio::Input open_files(const desk::studio::SessionFiles& files) {
  using namespace desk;
  studio::Input input;
  input.robot = read_robot_file(files.robot.path);
  ChannelOptions channels;
  if (files.channels) channels.file = files.channels->path;
  channels.payloads = files.payloads;
  Treated treated;
  for (const studio::NamedFile& file : files.logs) {
    treated.logs.push_back(read_log(file.path, input.robot, channels));
    input.log_files.push_back(file.name);
  }
  for (const studio::NamedFile& file : files.holdout) {
    treated.holdout.push_back(read_log(file.path, input.robot, channels));
    input.holdout_files.push_back(file.name);
  }
  treated.faults = treat_all({treated.logs, treated.holdout}, input.robot, {});
  input.recordings = std::make_shared<const Treated>(std::move(treated));
  input.robot_file = files.robot.name;
  input.payloads = files.payloads;
  if (files.channels) input.options = " --channels " + files.channels->name;
  return input;
}

}  // namespace offnominal::test
