#pragma once

#include <string>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {

// What a channel of the time is called in messages.
inline constexpr const char* kTimeWords = "time";

// The values of a channel in SI units; a scalar variable serves where it scales. `what`: the
// quantity in messages. `last`: nobody asks for these columns again, their memory is handed on.
// What is not finite stays so (usable_rows.hpp). Throws InputError where a column is missing, or a
// value is larger than anything that is measured.
[[nodiscard]] Eigen::VectorXd take_values(NamedColumns& columns, const Channel& channel,
                                          const std::string& what, bool last);

// Gives a channel that says no unit and no scale the unit that the file says of its source, with a
// remark. Throws InputError where that unit is none of the quantity's.
void take_unit_of_file(NamedColumns& columns, Channel& channel, ChannelQuantity quantity,
                       const std::string& what);

// "t, q1, q2", the first of what the file has.
[[nodiscard]] std::string names_found(const NamedColumns& columns);

inline constexpr const char* kMendNames =
    "map the names with [channels] in the robot's file, or with --channels FILE.toml; offnominal "
    "look proposes them";

}  // namespace offnominal::desk
