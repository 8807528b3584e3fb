#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "report/page.hpp"
#include "robot/robot.hpp"

// The on-board monitor over a recording, tick by tick, in double precision.

namespace offnominal::desk {

// A stretch of samples with |e| above the threshold, ends included.
struct Alarm {
  double start_s = 0;
  double end_s = 0;
  double max_error_to_threshold = 0;  // largest |e| / mu in it
};

// Samples that the monitor refused for one reason.
struct Refusals {
  std::int64_t count = 0;
  double first_s = 0;
};

struct Replay {
  std::string robot;
  std::string log;
  std::string unit;  // of |e|, mu: "rad/s", "m/s", or "1" where joints of both types are mixed
  double period_s = 0;
  int hidden_units = 0;
  std::uint32_t seed = 0;
  std::vector<std::string> joint_names;
  std::vector<std::string> acceleration_units;  // of psi_hat, per joint

  // One entry per sample that was accepted; times as in the recording.
  Eigen::VectorXd t_s;
  Eigen::MatrixXd error;       // e; rows: samples, columns: joints
  Eigen::VectorXd error_norm;  // |e|
  Eigen::VectorXd threshold;   // mu
  Eigen::MatrixXd psi_hat;     // rows: samples, columns: joints; rad/s^2 or m/s^2

  std::optional<double> detection_time_s;  // first alarm, time of the recording
  std::vector<Alarm> alarms;
  double max_error_to_threshold = 0;
  double max_weight_norm = 0;
  std::map<std::string, Refusals> refused;  // by the status' name
  std::int64_t longest_refused = 0;         // samples in a row

  [[nodiscard]] std::int64_t samples() const;  // accepted and refused
  [[nodiscard]] std::int64_t judged() const { return t_s.size(); }
  // Whether so many samples were refused that no alarm says nothing: more than two in a row, which
  // is as long as a controller bears it, or more than one in a hundred.
  [[nodiscard]] bool is_blind() const;
};

// Replays `log` through the monitor of `robot`, with the recording's sampling period as the tick.
// The recording's torque is taken as the torque that was really applied. Throws InputError when the
// recording has another number of joints, the robot file has no uncertainty bound, when a setting
// does not go with the sampling period, or when no sample is accepted.
[[nodiscard]] Replay replay(const RobotDescription& robot, const Log& log);

[[nodiscard]] nlohmann::json to_json(const Replay& replay);
[[nodiscard]] report::Page page_of(const Replay& replay, const std::string& command_line);

// What the replay says, in one sentence or two.
[[nodiscard]] std::string words_of(const Replay& replay);

}  // namespace offnominal::desk
