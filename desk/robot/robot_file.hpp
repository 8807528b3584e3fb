#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/file.hpp"
#include "robot/robot.hpp"

// A robot as a TOML file; docs/robot-file.md lists every key. Joints count from 1 in the file and
// in messages, from 0 in a RobotDescription.

namespace offnominal::desk {

inline constexpr int kRobotFileFormat = 1;

/// Whether numbers that torques depend on may be missing: a joint's mass and centre of mass, as
/// `offnominal new` leaves them.
enum class Blanks { kRefused, kAllowed };

/// Reads a robot file. Throws InputError with file, line, key path, what was found, what is allowed
/// and how to mend it at the first thing that is wrong; unknown keys are wrong. A description that
/// comes back is accepted by the core's validate(). Where blanks are refused, the message names the
/// first and says how many more there are; where they are allowed, the description lists them.
[[nodiscard]] RobotDescription read_robot_file(const std::filesystem::path& path,
                                               Blanks blanks = Blanks::kRefused);

/// The same for a text; `file` names it in messages.
[[nodiscard]] RobotDescription parse_robot(std::string_view text, const std::string& file,
                                           Blanks blanks = Blanks::kRefused);

/// Throws InputError, with `file` in it, where `who` ("the on-board monitor") would have to leave
/// an effect of the file out: one that no chain of the core can have, of a transmission that is not
/// rigid.
void require_carried(const RobotDescription& robot, const std::string& file,
                     const std::string& who = "the on-board monitor");

/// Throws InputError, with `file` in it, where the robot has no uncertainty bound, without which
/// there is no threshold, or as require_carried(): what runs the monitor needs both.
void require_bound(const RobotDescription& robot, const std::string& file);

/// The text of a robot file. Numbers have as many digits as it takes to get them back to the bit:
/// parse_robot(robot_text(robot)) == robot, for every robot that can be read.
[[nodiscard]] std::string robot_text(const RobotDescription& robot);

/// Whether the comments of the file that a robot was read from are in what was written.
enum class KeptComments { kAll, kNone };

/// Writes a robot file, whole or not at all. Where only effects and the uncertainty bound were
/// changed since `robot` was read, every other line stays as it was, comments and order included;
/// otherwise, or where they stand in a way that cannot be cut by lines, robot_text() is written.
/// Lines end as the first of that file does. Throws InputError, nothing written, when the text
/// would not be read again (a robot that was changed into a wrong one, or has blanks), when `path`
/// exists and `existing` refuses that, or when it cannot be written.
KeptComments write_robot_file(const RobotDescription& robot, const std::filesystem::path& path,
                              Existing existing = Existing::kRefuse);

}  // namespace offnominal::desk
