#pragma once

#include "analysis/shape_grid.hpp"
#include "discovery/effect_candidate.hpp"

// The families of effects, one file each. Every class is local to its file.

namespace offnominal::tools::discovery {

using Candidates = std::vector<std::unique_ptr<const EffectCandidate>>;

void add_friction_effects(Candidates& all);      // dissipation by the joint's own motion
void add_drive_effects(Candidates& all);         // torque measurement, motor, springs, time
void add_inertia_effects(Candidates& all);       // what is moved
void add_transmission_effects(Candidates& all);  // between motor and link

// Unit of a quantity at a joint of that type.
inline const char* unit(Quantity quantity, JointType type) {
  return offnominal::unit_of(quantity, type);
}

}  // namespace offnominal::tools::discovery
