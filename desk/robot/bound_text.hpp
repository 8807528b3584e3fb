#pragma once

#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// [uncertainty_bound] of a robot file, header included.
[[nodiscard]] std::string bound_text(const BoundSettings& bound);

}  // namespace offnominal::desk
