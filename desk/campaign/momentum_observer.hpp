#pragma once

#include <Eigen/Core>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::campaign {

/// The generalised momentum observer of A. De Luca and R. Mattone, "Sensorless robot collision
/// detection and hybrid force/motion control", ICRA 2005, equation (8):
///   r = K (p - integral of (tau - tau_f + C^T dq - g + r) dt - p(0)),   p = M(q) dq,
/// with one gain K, 1/s, of all joints, and the friction and other effects tau_f of `robot`. A
/// torque that the model does not know comes out as r, N m, through a first-order filter of that
/// pole. Integrated by the trapezoidal rule; r(0) = 0. Rows: samples of the log, columns: joints.
/// gain times the log's period has to be below 2. Throws std::invalid_argument where the robot is
/// no chain (chain_of.hpp).
[[nodiscard]] Eigen::MatrixXd momentum_residual(const RobotDescription& robot, double gain_per_s,
                                                const Log& log);

}  // namespace offnominal::desk::campaign
