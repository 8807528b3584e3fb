#include "command/write_robot.hpp"

#include <iostream>

#include "common/error.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {

void write_robot(const RobotDescription& robot, const std::string& from, const std::string& to,
                 const AnswerOptions& answer) {
  if (write_robot_file(robot, to, answer.existing()) == KeptComments::kAll) return;
  std::cerr << on_one_line("hint: " + to + " has none of the comments of " + from +
                           ": what changed is written there in a way that cannot be cut by lines; "
                           "write it under [uncertainty_bound] and [[effect]] to keep them")
            << '\n';
}

}  // namespace offnominal::desk
