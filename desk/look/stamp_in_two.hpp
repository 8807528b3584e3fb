#pragma once

#include <optional>

#include "log/named_columns.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// The sum of two columns that are one time, as a stamp of ROS is: whole seconds, and what has
// passed of each in ns, us or ms. By their names (sec and nanosec; stamp and stamp_nsec); or, of
// ns, by their numbers, where they stand side by side. None where no two are.
[[nodiscard]] std::optional<Channel> stamp_in_two(const NamedColumns& columns);

}  // namespace offnominal::desk
