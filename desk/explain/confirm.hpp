#pragma once

#include <Eigen/Core>

#include "identify/data.hpp"

namespace offnominal::desk {

// Root mean square position error per joint, rad or m, of forward simulations over short windows
// that each start on the measured motion: the torque error, through the mass matrix, integrated
// twice along the measured motion (first order in the error). NaN of hold maps: nothing moves
// there.
Eigen::VectorXd simulated_position_error(const Data& data, const Eigen::VectorXd& residual);

}  // namespace offnominal::desk
