#include "log/joint_side.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "robot/channels.hpp"
#include "robot/transmission.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

bool any_of_motors(const std::vector<ChannelOf>& of) {
  return std::any_of(of.begin(), of.end(), [](ChannelOf one) {
    return one == ChannelOf::kMotor || one == ChannelOf::kCurrent;
  });
}

// Joint per motor. What does not belong together is 0 exactly, so that nothing leaks from one joint
// into another.
MatrixXd joint_per_motor(const MatrixXd& per_joint, const std::vector<std::size_t>& group) {
  MatrixXd per_motor = per_joint.inverse();
  for (Index joint = 0; joint < per_motor.rows(); ++joint) {
    for (Index motor = 0; motor < per_motor.cols(); ++motor) {
      const bool apart =
          group[static_cast<std::size_t>(joint)] != group[static_cast<std::size_t>(motor)];
      if (apart) per_motor(joint, motor) = 0;
    }
  }
  return per_motor;
}

// Of the joints whose side is the motor's `columns` of motors become columns of joints: each row of
// `from_motors` is a joint.
void map_columns(const MatrixXd& from_motors, const std::vector<ChannelOf>& of, MatrixXd& columns) {
  const MatrixXd of_motors = columns;
  for (Index joint = 0; joint < columns.cols(); ++joint) {
    const ChannelOf side = side_at(of, static_cast<std::size_t>(joint));
    if (side != ChannelOf::kMotor && side != ChannelOf::kCurrent) continue;
    columns.col(joint) = of_motors * from_motors.row(joint).transpose();
  }
}

// The velocities of joints that share motors are all measured, or all derived.
void derive_what_lacks_a_motor(Log& log, const std::vector<std::size_t>& group) {
  const std::vector<ChannelOf>& of = log.channels.velocity_of;
  for (std::size_t joint = 0; joint < group.size(); ++joint) {
    if (side_at(of, joint) != ChannelOf::kMotor) continue;
    for (std::size_t motor = 0; motor < group.size(); ++motor) {
      if (group[motor] != group[joint] || log.channels.velocity[motor]) continue;
      log.dq_derived[joint] = true;
      log.remarks.push_back(
          fmt::format("the velocity of joint {} is derived from positions: motor {}, which moves "
                      "with it, has none",
                      joint + 1, motor + 1));
      break;
    }
  }
}

}  // namespace

void to_joint_side(Log& log, const TransmissionSettings& transmission) {
  const ChannelMap& map = log.channels;
  const MatrixXd per_joint = motor_per_joint(transmission);
  const std::vector<std::size_t> group = coupled_groups(transmission);
  const MatrixXd per_motor = joint_per_motor(per_joint, group);
  if (any_of_motors(map.position_of)) {
    const Eigen::VectorXd offset = motor_offset_rad(transmission);
    for (Index motor = 0; motor < log.q.cols(); ++motor) {
      if (side_at(map.position_of, static_cast<std::size_t>(motor)) == ChannelOf::kMotor) {
        log.q.col(motor).array() -= offset[motor];
      }
    }
    map_columns(per_motor, map.position_of, log.q);
  }
  if (any_of_motors(map.velocity_of)) {
    map_columns(per_motor, map.velocity_of, log.dq);
    derive_what_lacks_a_motor(log, group);
  }
  if (!any_of_motors(map.torque_of)) return;
  for (std::size_t motor = 0; motor < map.torque_of.size(); ++motor) {
    if (map.torque_of[motor] != ChannelOf::kCurrent) continue;
    log.tau.col(static_cast<Index>(motor)) *= transmission.torque_constant[motor];
  }
  map_columns(per_joint.transpose(), map.torque_of, log.tau);
}

}  // namespace offnominal::desk
