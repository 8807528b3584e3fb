#pragma once

#include <string>

#include "command/answer.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

/// Writes the robot that a verb made of the one in `from`, as write_robot_file(), and says on
/// stderr where the comments of that file are not in it.
void write_robot(const RobotDescription& robot, const std::string& from, const std::string& to,
                 const AnswerOptions& answer);

}  // namespace offnominal::desk
