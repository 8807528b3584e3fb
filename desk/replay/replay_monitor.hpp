#pragma once

#include "replay/replay.hpp"

namespace offnominal::desk {

// Hidden units that there is room for; fewer are exactly a smaller network.
inline constexpr int kReplayCapacity = 128;

// Fills in what the monitor says of every sample; a part of replay().
void replay_monitor(const RobotDescription& robot, const Log& log, Replay& result);

}  // namespace offnominal::desk
