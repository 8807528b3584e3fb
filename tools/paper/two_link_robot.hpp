// The paper's robot, part of the program.
#pragma once

#include "robot/robot.hpp"

namespace offnominal::tools::paper {

/// robots/two_link.toml as it stood when the program was built.
[[nodiscard]] RobotDescription two_link_robot();

}  // namespace offnominal::tools::paper
