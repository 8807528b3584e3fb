#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/toml_table.hpp"
#include "robot/robot.hpp"

// With the matrix A of n rows, one per motor, and n columns, one per joint, q the positions of the
// joints (rad or m) and i the motors' currents (A):
//   q_m = A q + offset    dq_m = A dq    tau = A^T tau_m    tau_m = torque_constant i
// The power tau . dq is that of the motors, tau_m . dq_m: what is lost between is an effect.
// B. Siciliano et al., Robotics, 2009, section 5.1 (one motor per joint); L.-W. Tsai, Robot
// Analysis, 1999, chapter 7 (coupled wrists).

namespace offnominal::desk {

/// The keys of [transmission].
[[nodiscard]] const std::vector<std::string>& transmission_keys();

/// [transmission] of a robot with `joint_count` joints. Its matrix has an inverse, no ratio and no
/// torque constant is 0.
[[nodiscard]] TransmissionSettings read_transmission(const TomlTable& table, int joint_count);

/// A.
[[nodiscard]] Eigen::MatrixXd motor_per_joint(const TransmissionSettings& transmission);

/// Offset of every motor, rad.
[[nodiscard]] Eigen::VectorXd motor_offset_rad(const TransmissionSettings& transmission);

/// Per joint, and per motor of the same number, the lowest number of those that move together: its
/// own where one motor moves one joint. From 0.
[[nodiscard]] std::vector<std::size_t> coupled_groups(const TransmissionSettings& transmission);

/// Throws InputError, of `file`, where channels are of motors and the robot's transmission does not
/// lead from there to the joints: there is none, it has no torque constants for currents, or joints
/// that share motors are measured on both sides.
void check_sides(const ChannelMap& channels,
                 const std::optional<TransmissionSettings>& transmission, const std::string& file);

}  // namespace offnominal::desk
