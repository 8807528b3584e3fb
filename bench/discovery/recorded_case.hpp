#pragma once

#include "log/log.hpp"
#include "offnominal/sim/hidden/case.hpp"
#include "robot/robot.hpp"

namespace offnominal::bench {

// A simulated recording as the analysis gets it: positions and torques, no velocities.
desk::Log log_of(const sim::hidden::Recording& recording);

// What the robot's owner knows, as a robot file would hold it. The friction's numbers are fitted
// ones, as in the files that `offnominal add` writes.
desk::RobotDescription robot_of(const sim::hidden::Nominal& nominal);

}  // namespace offnominal::bench
