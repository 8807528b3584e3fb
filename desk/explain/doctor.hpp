#pragma once

#include <vector>

#include "explain/data_fault.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// What is wrong with a recording, found before any physics. The robot is right within a few
// percent, effects worth 15 % of the torque may be missing in it, and the motion may be a poor one:
// where the recording does not show it clearly, nothing is said. Units that turn
// out to be others and positions that are folded into a turn are put right before the rest is
// looked at. Throws std::invalid_argument where the robot has another number of joints than the
// recording.
// Faults with spans are of those stretches alone.
std::vector<DataFault> examine(const Log& log, const RobotDescription& robot);

}  // namespace offnominal::desk
