#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

// Which files are one recording, where nobody said so.

namespace offnominal::desk::studio {

/// What of the signals that a robot is recorded by a file has for every joint, by the names of its
/// columns, or, where the robot file has [channels] that name some of them, for any joint by those.
struct SignalsIn {
  bool position = false;
  bool velocity = false;
  bool torque = false;
};
[[nodiscard]] SignalsIn signals_in(const NamedColumns& columns, const RobotDescription& robot);

struct FileToGroup {
  std::string name;
  SignalsIn has;
};

/// Indices of the files of each recording. Positions in one file, velocities or torques in others
/// are one recording; the file with the positions is the first, since they are what a straight line
/// between two samples would spoil. Of several that would do, those go together whose names have
/// most in common. All others are recordings of their own.
[[nodiscard]] std::vector<std::vector<std::size_t>> groups_of(
    const std::vector<FileToGroup>& files);

/// "positions in a.csv, torques in b.csv"
[[nodiscard]] std::string words_of(const std::vector<FileToGroup>& group);

}  // namespace offnominal::desk::studio
