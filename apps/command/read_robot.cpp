#include "command/read_robot.hpp"

#include <fmt/format.h>

#include <iostream>

#include "common/error.hpp"
#include "robot/doubts_of_limits.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {

RobotDescription read_robot(const std::string& file) {
  RobotDescription robot = read_robot_file(file);
  for (const std::string& doubt : doubts_of_limits(robot)) {
    std::cerr << on_one_line(fmt::format("hint: {}: {}", file, doubt)) << '\n';
  }
  return robot;
}

}  // namespace offnominal::desk
