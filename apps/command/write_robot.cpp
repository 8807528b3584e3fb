#include "command/write_robot.hpp"

#include <iostream>

#include "common/error.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {

void write_robot(const RobotDescription& robot, const std::string& from, const std::string& to,
                 const AnswerOptions& answer) {
  if (write_robot_file(robot, to, answer.existing()) == KeptComments::kAll) return;
  std::cerr << on_one_line("hint: " + to + " has none of the comments of " + from +
                           ": a number that changed stands there over several lines, in a table "
                           "within braces, or not at all; write [joint.link], [[effect]] and "
                           "[uncertainty_bound] a key a line, as docs/robot-file.md does, to keep "
                           "them")
            << '\n';
}

}  // namespace offnominal::desk
