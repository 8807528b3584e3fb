#pragma once

#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

// The robot file of a verb; what may be meant otherwise in it is a hint on standard error.
[[nodiscard]] RobotDescription read_robot(const std::string& file);

}  // namespace offnominal::desk
