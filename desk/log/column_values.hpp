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

// Gives a channel that says no unit and no scale the unit that the file says of its source in a
// line of units, with a remark, also of a unit that is not known or stands in the column's name,
// which nobody takes unasked. Throws InputError where that unit is none of the quantity's.
void take_unit_of_file(NamedColumns& columns, Channel& channel, ChannelQuantity quantity,
                       const std::string& what);

// What stands in brackets at the end of a column's name and is no number of it: "Nm" of
// "tau1 [Nm]", empty of "q(2,:)".
[[nodiscard]] std::string unit_in_name(const std::string& name);

// "\"furlong\" is no unit that is known: taken as N m"
[[nodiscard]] std::string words_of_unknown_unit(const std::string& unit, ChannelQuantity quantity);

// "t, q1, q2", the first of what the file has.
[[nodiscard]] std::string names_found(const NamedColumns& columns);

inline constexpr const char* kMendNames =
    "map the names with [channels] in the robot's file, or with --channels FILE.toml; offnominal "
    "look proposes them";

}  // namespace offnominal::desk
