#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "compare/motion.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// Friction takes energy out of its joint, all of it together: the excess of a joint near standstill
// or of a cold one may well be negative where enough Coulomb friction stands beside it. Core's
// trait says which effects are friction.
bool is_friction(EffectKind kind);

// Friction that gives energy to its joint.
struct FrictionDrives {
  std::size_t joint = 0;
  double torque = 0;  // N m or N with the motion, on average where it is largest
  std::string where;  // "from 0.1 to 0.4 rad/s"
  // Over what it may be for nothing: else no friction at all fits as well.
  bool contradicted = false;

  // A sentence without its full stop.
  [[nodiscard]] std::string words(const RobotDescription& robot) const;
};

// Judges the friction of one joint of the robot over a motion: on average in no tenth of the
// moving samples, by speed or by time, may it drive the joint with more than 2 % of `rms_torque`,
// and on the whole not at all. None where it does not, and where nothing moves.
std::optional<FrictionDrives> friction_that_drives(const RobotDescription& robot, std::size_t joint,
                                                   const Motion& motion, double rms_torque);

}  // namespace offnominal::desk
