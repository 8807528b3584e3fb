#pragma once

#include "common/toml_table.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// Refuses the effect that takes away more mass than there is to move: where masses below zero
/// leave the mass matrix not positive definite somewhere in the joints' range. `root` is the robot
/// file.
void check_mass_matrix(const TomlTable& root, const RobotDescription& robot);

}  // namespace offnominal::desk
