// What an error of measured velocities does to the momentum M(q) dq.
#pragma once

#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// Per joint: by how much its momentum is wrong at most, N m s or N s, where the velocity of every
/// joint is wrong by 1 rad/s or m/s at most: the largest sum |M_i1| + |M_i2| + ... over 2000 poses
/// of the joints' ranges, the same every time, and a tenth more for those between them.
[[nodiscard]] std::vector<double> momentum_per_velocity(const RobotDescription& robot);

}  // namespace offnominal::desk
