#pragma once

#include <filesystem>
#include <optional>

#include "look/look.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What the channels of the robot's file read of a recording, as `compare` reads it, its
// transmission applied; proposed is what they do not say. Throws InputError where they do not read
// it. `robot` has channels.
[[nodiscard]] Look look_by_channels(const std::filesystem::path& path,
                                    const RobotDescription& robot, std::optional<double> period_s);

}  // namespace offnominal::desk
