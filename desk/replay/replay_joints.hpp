#pragma once

#include "replay/replay.hpp"

namespace offnominal::desk::detail {

// Hidden units that are compiled in; fewer are exactly a smaller network.
inline constexpr int kReplayCapacity = 128;

// The replay for one number of joints, 1 to kMaxJoints.
template <int N>
void replay_joints(const RobotDescription& robot, const Log& log, Replay& result);

}  // namespace offnominal::desk::detail
