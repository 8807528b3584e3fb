#pragma once

#include <string>
#include <string_view>

#include "robot/robot.hpp"

namespace offnominal::desk {

/// One key of [channels], "time", "position", "velocity" or "torque", as a robot file has it:
/// position = [{source = "q1"}, {source = "q2", scale = 0.5}]
[[nodiscard]] std::string channel_line(const ChannelMap& channels, std::string_view key);

}  // namespace offnominal::desk
