#pragma once

#include <string>

#include "robot/robot.hpp"

namespace offnominal::desk {

// Throws InputError, of the recording `file`, where a channel of a joint has a unit of the other
// kind of joint and no scale: degrees of one that slides, N of one that turns.
void check_units_of_joints(const ChannelMap& channels, const RobotDescription& robot,
                           const std::string& file);

}  // namespace offnominal::desk
