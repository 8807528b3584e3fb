#pragma once

#include <Eigen/Core>

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::campaign {

/// Joint torques that Orocos KDL's ChainExternalWrenchEstimator holds for external (Debian's
/// liborocos-kdl-dev 1.5.1, kdl/chainexternalwrenchestimator.hpp, a momentum observer after
/// S. Haddadin, A. De Luca, A. Albu-Schaeffer, "Robot collisions: a survey on detection, isolation,
/// and identification", IEEE Transactions on Robotics 33(6), 2017). KDL knows rigid bodies and
/// rotor inertias of joints: it is given the torque that `robot`'s friction and other effects leave
/// of the drives'. `filter_share`: its filter constant, 0 (none) to below 1. Rows: samples of the
/// log, columns: joints, N m. Throws std::runtime_error with KDL's own words where it gives up, and
/// InputError where rotors belong to motors that joints share.
[[nodiscard]] Eigen::MatrixXd kdl_residual(const RobotDescription& robot, double gain_per_s,
                                           double filter_share, const Log& log);

}  // namespace offnominal::desk::campaign
