// The paper's robot, part of the program.
#pragma once

#include "robot/robot.hpp"

namespace offnominal::desk::paper {

/// robots/two_link.toml as it stood when the program was built.
[[nodiscard]] RobotDescription two_link_robot();

/// Whether the rigid body of a robot is that of the paper's arm, whatever its effects and settings.
[[nodiscard]] bool is_two_link_arm(const RobotDescription& robot);

}  // namespace offnominal::desk::paper
