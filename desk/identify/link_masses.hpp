#pragma once

#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

// Links of `improved` whose mass no file is so wrong about, one sentence each: the torque is in
// another unit. Ten times off `file`, or as little. A link that is next to nothing of the arm
// stands for something else in a file, a frame or a flange, and may hold what the arm carries: up
// to the mass of the whole arm.
std::vector<std::string> masses_beyond_belief(const RobotDescription& file,
                                              const RobotDescription& improved);

}  // namespace offnominal::desk
