#pragma once

#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// What may be meant otherwise in a robot file and is taken as it stands: position limits of joints
/// that turn which look like degrees. A line each, with how to mend it.
[[nodiscard]] std::vector<std::string> doubts_of_limits(const RobotDescription& robot);

}  // namespace offnominal::desk
