#pragma once

#include <string>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// [uncertainty_bound] of a robot file, header included.
[[nodiscard]] std::string bound_text(const BoundSettings& bound);

/// The keys of Kind::kPerJoint, `kind` first, without a line break at the end: the joints'
/// constants in one list, what depends on a position, speed or load in tables of one line.
[[nodiscard]] std::string joint_bounds_text(const BoundSettings& bound);

}  // namespace offnominal::desk
