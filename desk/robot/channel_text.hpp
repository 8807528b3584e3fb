#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// The whole table as a robot file has it, its header the first line.
[[nodiscard]] std::string channels_table(const ChannelMap& channels);

/// The lines of [channels] that say one quantity, "time", "position", "velocity" or "torque", as a
/// robot file has them: position = [{source = "q1"}, {source = "q2", scale = 0.5}]
/// One line, or one for each side that a joint's channel is of.
[[nodiscard]] std::vector<std::string> channel_lines(const ChannelMap& channels,
                                                     std::string_view quantity);

}  // namespace offnominal::desk
