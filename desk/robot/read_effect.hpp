#pragma once

#include <string>
#include <vector>

#include "common/toml_table.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// Every key that an [[effect]] of any kind can have.
[[nodiscard]] const std::vector<std::string>& effect_keys();

/// Every effect's name, in the order of the core's list.
[[nodiscard]] const std::vector<std::string>& effect_names();

/// The effects that a robot file may have, those that no on-board monitor can carry last.
[[nodiscard]] const std::vector<const EffectInfo*>& file_effects();

// Whether a robot file may have the effect on a motor's shaft: what motor_may_have(), and what
// gives way behind the shaft, which is no part of a chain.
[[nodiscard]] constexpr bool file_motor_may_have(EffectKind kind) {
  return motor_may_have(kind) || kind == EffectKind::kJointElasticity;
}

/// One [[effect]] of a robot with these joints; of a motor only where it has a transmission.
[[nodiscard]] RobotEffect read_effect(const TomlTable& table, const std::vector<RobotJoint>& joints,
                                      bool has_transmission);

}  // namespace offnominal::desk
