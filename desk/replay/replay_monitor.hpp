#pragma once

#include <cstdint>

#include "replay/replay.hpp"

namespace offnominal::desk {

// Hidden units that there is room for; fewer are exactly a smaller network.
inline constexpr int kReplayCapacity = 128;

// Samples refused in a row that the monitor goes on behind, as many as a controller bears.
inline constexpr std::int64_t kBorneInARow = 2;

// Fills in what the monitor says of every sample; a part of replay(), in a source of its own.
void replay_monitor(const RobotDescription& robot, const Log& log, Replay& result);

}  // namespace offnominal::desk
