#pragma once

#include "offnominal/sim/hidden/draws.hpp"
#include "robot/robot.hpp"

namespace offnominal::bench {

// An arm of six or seven joints as arms are built: an industrial one with a spherical wrist, a
// collaborative one with three parallel axes, or one of seven joints with two ball joints. Reach
// 0.6 to 1.8 m, links of 2 to 80 kg; lengths, masses and inertias drawn, each link a body that
// there may be. Rigid bodies alone: neither effects nor limits.
desk::RobotDescription draw_rigid_arm(sim::hidden::Draws& draws);

double total_mass_kg(const desk::RobotDescription& robot);

void add_effect(desk::RobotDescription& robot, EffectKind kind, Eigen::Index joint,
                std::array<double, kMaxEffectParameters> parameters);

}  // namespace offnominal::bench
