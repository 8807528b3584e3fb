#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "compare/measurement.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// A variable of one joint that the error may follow.
struct ErrorShare {
  std::string variable;  // "position", "velocity", "acceleration", "time", "recording"
  double share = 0;      // of the error's energy, 0..1, that the mean over bins of it explains
};

// What the drive gives and a sensor behind the gear does not get: all that gear and rotor take,
// whatever the model says.
struct GearTorque {
  double rms = 0;      // of drive less sensor, both filtered; N m or N
  double percent = 0;  // 100 |drive - sensor| / |drive|; NaN where the drive's is 0
  ErrorShare follows;  // the variable of the motion that explains most of it
};

// How well the model's torque tau_m meets the measured torque tau at one joint, both filtered.
struct JointComparison {
  std::size_t joint = 0;              // from 0
  std::string unit;                   // "N m" or "N"
  double rms_error = 0;               // of tau - tau_m
  double rms_torque = 0;              // of tau
  double relative_error_percent = 0;  // 100 |tau - tau_m| / |tau|; NaN where tau is 0
  double fit_percent = 0;             // 100 (1 - |tau - tau_m| / |tau - mean|); NaN where constant
  // Of the samples, 0..1: those in which the joint stands still, where friction may take any part
  // of the torque, and those at fault. None of the numbers above is of them.
  double left_out = 0;
  double at_fault = 0;             // of the samples, 0..1: those in which the recording is at fault
  Eigen::Index samples = 0;        // that are left; the numbers above are NaN where none is
  std::vector<ErrorShare> where;   // largest share first
  std::optional<GearTorque> gear;  // where the recording has both torques
};

struct Comparison {
  std::string file;                // the recording, as the user named it
  std::optional<Payload> payload;  // that the robot carried in it
  FilterPlan plan;
  Eigen::VectorXd t_s;       // of the kept samples
  Eigen::MatrixXd measured;  // filtered torque; rows: kept samples, columns: joints
  Eigen::MatrixXd model;
  Eigen::MatrixXd sensor;  // the same of a sensor behind the gear; empty: none anywhere
  std::vector<char>
      has_both;       // per joint: 1 where `sensor` has a column of it that means something
  Eigen::MatrixXd q;  // low-passed motion at the kept samples
  Eigen::MatrixXd dq;
  Eigen::MatrixXd ddq;
  Eigen::MatrixXd moving;    // 1, or 0 where the joint does not count: Measurement
  Eigen::VectorXd at_fault;  // per joint, share of the samples: Measurement
  std::vector<JointComparison> joints;
  std::vector<std::string> remarks;  // the recording's

  [[nodiscard]] Eigen::MatrixXd residual() const { return measured - model; }
};

// One robot file against several recordings: each of them, and all of them together.
struct Comparisons {
  std::vector<Comparison> recordings;   // one or more, of the same joints
  std::vector<JointComparison> joints;  // of all their samples together
};

// `robot` has as many joints as the recording.
Comparison compare(const RobotDescription& robot, const Measurement& measured);
// The same, to the bit, with what is kept of the robot that was compared before.
Comparison compare(const RobotDescription& robot, const Measurement& measured,
                   ModelTorqueMemory& memory);

// The numbers of all samples together. Times are taken one recording after the other; where there
// are several, the error may also follow the "recording": be one in this and another in that.
Comparisons together(std::vector<Comparison> recordings);

// Share of the energy of `values` (about their mean) that their means over `bins` equally filled
// bins of `variable` explain: 0 none, 1 all of it. 0 where the variable or the values are constant.
double share_explained(const Eigen::Ref<const Eigen::VectorXd>& variable,
                       const Eigen::Ref<const Eigen::VectorXd>& values, int bins = 40);

}  // namespace offnominal::desk
