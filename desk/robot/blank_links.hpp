#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// A robot of whose links some are blanks: neither mass nor centre of mass nor inertia stand there.
/// Those of a Joint by default take their place, and mean nothing.
struct RobotWithBlanks {
  RobotDescription robot;
  std::vector<char> is_blank;  // per joint, 1 or 0
};

/// As parse_robot() and read_robot_file() (robot_file.hpp), but for such links.
[[nodiscard]] RobotWithBlanks parse_robot_with_blanks(std::string_view text,
                                                      const std::string& file);
[[nodiscard]] RobotWithBlanks read_robot_with_blanks(const std::filesystem::path& path);

}  // namespace offnominal::desk
