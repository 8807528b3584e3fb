#pragma once

#include "log/joined_files.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What read_log() makes of columns that were read already: those that `channels` want, by their
// names, and the time. Throws as it does.
[[nodiscard]] Log log_of(TimedColumns recording, const RobotDescription& robot,
                         const ChannelMap& channels);

}  // namespace offnominal::desk
