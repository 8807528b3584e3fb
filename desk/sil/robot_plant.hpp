// The robot of a file as a plant: its rigid body, its effects, and what only the plant knows of.
#pragma once

#include <memory>
#include <vector>

#include "offnominal/sim/bus/fault_event.hpp"
#include "offnominal/sim/plant.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk::sil {

struct RobotPlantSetup {
  RobotDescription robot;           // rigid body and effects
  std::vector<RobotEffect> hidden;  // that no model knows
  /// mass_loss, payload and friction_jump act here; others have no effect. Of a mass that falls off
  /// or hangs on, the plant keeps the velocity of its joints.
  std::vector<sim::FaultEvent> faults;
  sim::JointState start;
  double period_s = 0.001;  // of every step
};

/// 1 to kMaxJoints joints. The dynamics are the core's, in double precision: model and plant differ
/// in what is hidden, in faults and in what the bus resolves, in nothing else. Integrated by a
/// linearly implicit method of second order, so that friction on a light link, however steep at
/// rest, does not bound the step. Throws InputError for effects that the core refuses.
[[nodiscard]] std::unique_ptr<sim::Plant> make_robot_plant(const RobotPlantSetup& setup);

}  // namespace offnominal::desk::sil
