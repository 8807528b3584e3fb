#pragma once

#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// One [[effect]] of a robot file, header included; empty for a number that is no effect.
[[nodiscard]] std::string effect_text(const RobotEffect& effect);

/// Where it acts: "joint 2", or "motor 2".
[[nodiscard]] std::string place_of(const Effect<double>& effect);

}  // namespace offnominal::desk
