#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibrate/recorded_error.hpp"
#include "robot/robot.hpp"

// A bound mu_bar that is linear in numbers to be found: mu_bar = sum of c_k phi_k(q, dq, tau), each
// phi_k >= 0. After the filter the threshold is mu = sum of c_k W_alpha[phi_k] + 2 v, linear in the
// c_k and in the velocity error v.

namespace offnominal::desk {

struct BoundShape {
  BoundSettings settings;  // kind, matrix, variable and points; its numbers mean nothing
  int size = 1;            // how many c_k: constant 1, scaled_norm 2, table one per point
  std::string words;       // "scaled_norm, matrix [[2, -6]]"
};

/// The bound with these c_k and this v, every number rounded up to four digits, so that it is
/// nowhere below what was asked for. c_k > 0.
[[nodiscard]] BoundSettings bound_with(const BoundShape& shape, const Eigen::VectorXd& coefficients,
                                       double velocity_error);

/// Shapes to choose from: constant; scaled norms of all velocities, of the accelerations that equal
/// friction on every joint would cause at the recordings' mean position, of each joint's velocity,
/// and of the robot file's own matrix; tables over position, speed and torque of each joint, with
/// points where the recordings have samples.
[[nodiscard]] std::vector<BoundShape> bound_shapes(const RobotDescription& robot,
                                                   const std::vector<RecordedError>& recordings);

/// Of one joint alone, for EstimatorSpace::kTorque: constant, and tables over its own speed, load
/// and position; not over a load that acts later than it is recorded (time_delay).
[[nodiscard]] std::vector<BoundShape> joint_bound_shapes(
    const RobotDescription& robot, int joint, const std::vector<RecordedError>& recordings);

/// What the c_k of a shape contribute to the threshold in the run that the recording is. Rows:
/// samples, row 0 (the start) is not judged. The velocity error v adds 2 times the recording's
/// scale from the start on.
[[nodiscard]] Eigen::MatrixXd filtered_basis(const RobotDescription& robot, const BoundShape& shape,
                                             const RecordedError& recording);

}  // namespace offnominal::desk
