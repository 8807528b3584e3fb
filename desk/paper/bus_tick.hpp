// What lies between controller and arm at a tick, where that is a bus.
#pragma once

#include "offnominal/sim/joint_state.hpp"

namespace offnominal::desk::paper {

struct BusTick {
  bool fresh = false;             // the controller had a reading of every joint
  sim::JointState seen;           // which, as it took them
  sim::JointVector seen_tau;      // torque that the drives said they gave
  sim::JointVector acting_tau;    // that really acted on the joints
  sim::JointVector compensation;  // what of seen_tau the controller adds for what is off nominal
};

}  // namespace offnominal::desk::paper
