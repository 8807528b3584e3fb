#pragma once

#include <string>
#include <vector>

#include "offnominal/sim/hidden/case.hpp"

namespace offnominal::bench {

// A number that the analysis should find.
struct ExpectedParameter {
  std::string name;  // as in Finding::parameters
  double value = 0;
  double scale = 0;  // an error of a tenth of this is 10 %
};

// The simulator's truth in the conventions of the analysis; the only place where the two meet.
//
// | effect | simulator | analysis |
// |---|---|---|
// | load_dependent_friction | coefficient | factor, the same number |
// | torque_scale | share s: gives (1 + s) times what is logged | error of the logged torque against
//   the model's: 1 / (1 + s) - 1 |
// | backlash | gap | width, both the full play |
// | joint_elasticity | stiffness, damping | stiffness; damping is not modelled |
// | time_delay | delay of the drive d | a row is held for a period T, which makes it late by T / 2
//   in the mean: d + T / 2 |
// | periodic_disturbance | phase at the instant | a row's torque answers what acts T / 2 later in
//   the mean: the phase is ahead by frequency * T / 2 |
// | joint_coupling | coefficient or level | both; the one that is there is compared |
//
// What the simulator does not have (width of a smoothed sign, share of an operator) is left out.
// A sine and a cosine are compared on the scale of their amplitude, since either may be 0; a rest
// position on the scale of the motion, 1 rad; everything else on its own size.
std::vector<ExpectedParameter> expected_parameters(const sim::hidden::TrueEffect& truth,
                                                   double sampling_period_s);

}  // namespace offnominal::bench
