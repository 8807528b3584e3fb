#pragma once

#include "offnominal/sim/hidden/draws.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::campaign {

/// What a drawing says of a robot: each link's mass, centre and inertia off by up to `error` (a
/// share, 0 to below 1; of a centre, of the link's radius of gyration), still a body that there may
/// be.
[[nodiscard]] RobotDescription with_cad_errors(RobotDescription robot, double error,
                                               sim::hidden::Draws& draws);

/// Every effect but rotor inertias has its first number off by the share `error`, up or down.
[[nodiscard]] RobotDescription with_friction_errors(RobotDescription robot, double error,
                                                    sim::hidden::Draws& draws);

}  // namespace offnominal::desk::campaign
