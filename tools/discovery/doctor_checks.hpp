#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "discovery/data_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

// The doctor's checks one by one; doctor.hpp puts them in order.

namespace offnominal::tools::discovery {

// Measured and model torque of a recording, low-passed alike and thinned out. Rows: samples,
// columns: joints.
struct TorquePair {
  double period_s = 0;
  double cutoff_hz = 0;
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q;
  Eigen::MatrixXd dq;
  Eigen::MatrixXd ddq;
  Eigen::MatrixXd measured;
  Eigen::MatrixXd model;               // of the robot with its effects
  Eigen::MatrixXd load;                // of the robot without effects
  std::vector<Eigen::MatrixXd> links;  // share of each link in `load`
};

// None where the recording is too short for a low-pass, or its model torque is not finite.
std::optional<TorquePair> torque_pair(const Log& log, const RobotDescription& robot);

void find_gaps(const Log& log, std::vector<DataFault>& faults);
void find_stale_samples(const Log& log, std::vector<DataFault>& faults);
void find_stuck_encoders(const Log& log, const RobotDescription& robot,
                         std::vector<DataFault>& faults);
void find_saturation(const Log& log, const RobotDescription& robot, std::vector<DataFault>& faults);
void find_torque_sign(const TorquePair& pair, std::vector<DataFault>& faults);
void find_clock_skew(const Log& log, const TorquePair& pair, std::vector<DataFault>& faults);

// The recording with the positions of the revolute joints in radians; says so where they were not.
Log without_degrees(const Log& log, const RobotDescription& robot, std::vector<DataFault>& faults);

// "joint 2", or "all joints" for -1.
std::string joint_words(Eigen::Index joint);

// Lag of the torque behind the positions on some rows of one joint.
struct LagEstimate {
  double lag_s = 0;         // torque late where positive
  double likelihood = 0;    // log-likelihood gained over the best lag within honest_s
  double independence = 0;  // share of the torque's rate that nothing else beside it can be
  bool at_end = false;      // best at the end of the range that was looked at
};
// Everything that the model may lack and that does not depend on time is fitted beside it. The
// model is right within a few percent.
LagEstimate estimate_lag(const TorquePair& pair, Eigen::Index joint, Eigen::Index first,
                         Eigen::Index count, double honest_s);

}  // namespace offnominal::tools::discovery
