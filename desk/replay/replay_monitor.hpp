#pragma once

#include "replay/replay.hpp"

namespace offnominal::desk {

// Fills in what the monitor says of every sample; a part of replay().
void replay_monitor(const RobotDescription& robot, const Log& log, const OnShare& on_share,
                    Replay& result);

}  // namespace offnominal::desk
