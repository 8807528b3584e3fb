#pragma once

#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// One [[effect]] of a robot file, header included; empty for a number that is no effect.
[[nodiscard]] std::string effect_text(const RobotEffect& effect);

}  // namespace offnominal::desk
