#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "compare/motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The ten numbers of a link in which its torque is linear: mass, kg; first moment x, y, z, kg m;
// inertia xx, yy, zz, xy, xz, yz about the origin of the link's frame, kg m^2 (C. G. Atkeson, C. H.
// An, J. M. Hollerbach, IJRR 5(3), 1986).
inline constexpr Eigen::Index kInertialNumbers = 10;
using InertialNumbers = Eigen::Matrix<double, kInertialNumbers, 1>;

// "m", "hx", "hy", "hz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"
const char* symbol_of_inertial_number(Eigen::Index number);
// "kg", "kg m" or "kg m^2"
const char* unit_of_inertial_number(Eigen::Index number);

InertialNumbers inertial_numbers_of(const Joint<double>& joint);

// d torque / d number over a motion, the numbers of one link in turn, by core's recursion: rows are
// samples, columns joints, N m or N. Joints behind the link's own are 0. Effects play no part.
std::vector<Eigen::MatrixXd> inertial_regressor(const RobotDescription& robot, std::size_t link,
                                                const Motion& motion);

}  // namespace offnominal::desk
