#pragma once

#include <Eigen/Core>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// How a joint's columns are to be read: the file's position is zero + (or minus) the recorded one.
struct Reading {
  double zero = 0;  // rad
  bool position_turned = false;
  bool torque_turned = false;

  [[nodiscard]] bool is_as_it_is() const { return zero == 0 && !position_turned && !torque_turned; }
};
using Readings = std::vector<Reading>;

// The samples of a recording, few of them, and what the model says of them read in another way, or
// with other masses. Shares are of the torque about its mean, beside any friction, rotor and offset
// of the joint's drive.
class Rereading {
 public:
  Rereading(const Log& log, const RobotDescription& robot, const TorquePair& pair);

  // Share of each joint's torque that is left; 0 of one that does not move.
  [[nodiscard]] Eigen::VectorXd left_of_each(const Readings& readings) const;

  // Rms over the joints that move.
  [[nodiscard]] double left_by(const Readings& readings) const;

  // The same as the recording stands, but with other masses: other_masses.hpp. `noise`: the share
  // that counts as such.
  [[nodiscard]] double left_by_masses(double noise) const;

  [[nodiscard]] bool turns(Eigen::Index joint) const {
    return rigid_.joints[static_cast<std::size_t>(joint)].joint.type == JointType::kRevolute;
  }

 private:
  [[nodiscard]] double rms_of_telling(const Eigen::VectorXd& left_of_each) const;

  RobotDescription rigid_;
  TorquePair rows_;
  Eigen::MatrixXd of_effects_;  // as the recording stands
  std::vector<double> sizes_;   // per joint, of the torque about its mean; 0: it tells nothing
};

}  // namespace offnominal::desk
