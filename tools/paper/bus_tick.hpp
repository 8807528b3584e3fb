// What lies between controller and arm at a tick, where that is a bus.
#pragma once

#include <Eigen/Core>

#include "offnominal/sim/two_link_plant.hpp"

namespace offnominal::tools::paper {

struct BusTick {
  bool fresh = false;    // the controller had a reading of every joint
  sim::JointState seen;  // which, as it took them
  Eigen::Vector2d seen_tau = Eigen::Vector2d::Zero();    // torque that the drives said they gave
  Eigen::Vector2d acting_tau = Eigen::Vector2d::Zero();  // that really acted on the joints
};

}  // namespace offnominal::tools::paper
