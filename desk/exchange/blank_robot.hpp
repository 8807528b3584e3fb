#pragma once

#include <string>

#include "exchange/dh_table.hpp"
#include "robot/robot.hpp"

// A robot file for an arm of which nothing but the geometry is known.

namespace offnominal::desk::exchange {

/// The joints of a table: axis z each, frames as the convention has them. The links' masses are
/// those of a RobotJoint by default, and mean nothing.
[[nodiscard]] std::vector<RobotJoint> joints_of(const DhTable& table);

/// The robot file's text: what is not known stands as a comment with its unit, for whoever fills it
/// in. Reading it says which key is missing first. `table_file` names the table.
[[nodiscard]] std::string blank_robot_text(const DhTable& table, const std::string& name,
                                           const std::string& table_file);

}  // namespace offnominal::desk::exchange
