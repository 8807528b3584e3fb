#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

// One recording in SI units, evenly sampled, time ascending, every number finite. Or a hold map
// (hold_map.hpp), where at_rest.
struct Log {
  std::string file;     // as the user named it
  double period_s = 0;  // sampling period
  Eigen::VectorXd t_s;  // as recorded, or the even grid it was resampled to
  Eigen::MatrixXd q;    // rows: samples, columns: joints; rad or m
  Eigen::MatrixXd dq;   // rad/s or m/s
  // Torque of the drive, at the joint; or what a sensor behind the gear says, where that is all
  // there is of a joint (of_sensor()). N m or N.
  Eigen::MatrixXd tau;
  // What such a sensor says beside tau: columns as tau, those of other joints 0; no rows where no
  // joint has both (has_both()).
  Eigen::MatrixXd sensor_tau;
  std::vector<bool> dq_derived;  // per joint: dq is the derivative of the low-passed q
  std::map<std::string, Eigen::VectorXd> extra;  // further quantities, by name
  bool at_rest = false;
  Eigen::MatrixXd approach;             // where at_rest: 1 or -1, as q; else empty
  std::vector<std::string> remarks;     // what a reader of results has to know, in words
  ChannelMap channels;                  // where the columns came from; empty: not read from a file
  bool common_header = false;           // by their names alone, nobody gave the channels
  std::optional<Payload> payload = {};  // that the robot carried (robot/payload.hpp)

  [[nodiscard]] bool of_sensor(std::size_t joint) const {
    return joint < channels.torque_of.size() && channels.torque_of[joint] == ChannelOf::kSensor;
  }
  [[nodiscard]] bool has_both(std::size_t joint) const {
    return joint < channels.sensor_torque.size() && channels.sensor_torque[joint].has_value();
  }
  [[nodiscard]] int joint_count() const { return static_cast<int>(q.cols()); }
  [[nodiscard]] Eigen::Index sample_count() const { return t_s.size(); }
  [[nodiscard]] double sample_rate_hz() const { return 1 / period_s; }
};

}  // namespace offnominal::desk
