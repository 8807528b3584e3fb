#pragma once

#include <memory>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

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

// Rows `first`, `first` + `step` and so on of some columns of a CSV, counted from 0, and the time
// of its first column later by `later_s`.
inline std::string part_of_csv(const std::string& csv, const std::vector<std::size_t>& columns,
                               std::size_t first, std::size_t step, double later_s) {
  std::istringstream lines(csv);
  std::string part;
  std::string line;
  for (std::size_t row = 0; std::getline(lines, line); ++row) {
    if (row > 0 && (row - 1 < first || (row - 1 - first) % step != 0)) continue;
    std::vector<std::string> cells;
    std::istringstream all(line);
    for (std::string cell; std::getline(all, cell, ',');) cells.push_back(cell);
    if (row > 0) cells[0] = std::to_string(std::stod(cells[0]) + later_s);
    for (const std::size_t column : columns) {
      part += (column == columns.front() ? "" : ",") + cells.at(column);
    }
    part += "\n";
  }
  return part;
}

// The same recording in two files: positions and velocities, and torques in half as many samples
// between them, whose clock may be another one.
inline std::string strange_positions(double amplitude) {
  return part_of_csv(strange_csv(amplitude), {0, 1, 2, 3, 4}, 0, 1, 0);
}
inline std::string strange_torques(double amplitude, double later_s = 0) {
  return part_of_csv(strange_csv(amplitude), {0, 5, 6}, 1, 2, later_s);
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
    treated.logs.back().file = file.name;
    input.log_files.push_back(file.name);
  }
  for (const studio::NamedFile& file : files.holdout) {
    treated.holdout.push_back(read_log(file.path, input.robot, channels));
    treated.holdout.back().file = file.name;
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
