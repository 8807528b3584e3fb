#pragma once

#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Turns what a recording has of motors, as log.channels say, into what it is at the joints
// (robot/transmission.hpp has the equations). The columns of q, dq and tau hold what the channels
// gave: motor positions in rad, velocities in rad/s, torques in N m or currents in A, of the motor
// with the joint's number. Where a motor of a joint has no velocity, that of the joint is marked as
// derived, with a remark where it is another's. The channels fit (check_sides()).
void to_joint_side(Log& log, const TransmissionSettings& transmission);

}  // namespace offnominal::desk
