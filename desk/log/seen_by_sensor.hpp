#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "robot/robot.hpp"

// Where all that a recording has of a joint's torque is what a sensor behind the gear says,
// effects before it do not show: those of motors that move the joint, and those with
// EffectTraits::is_before_sensor.

namespace offnominal::desk {

/// The effects of the robot that the recording does not show, as indices.
[[nodiscard]] std::vector<std::size_t> hidden_from_sensors(const RobotDescription& robot,
                                                           const Log& log);

/// The robot as the recording shows it, without these.
[[nodiscard]] RobotDescription seen_by_sensors(const RobotDescription& robot, const Log& log);

/// Throws InputError where there are some: no fit to the recording could say anything of them.
void refuse_hidden_from_sensors(const RobotDescription& robot, const Log& log);

/// What whoever reads results of the recording has to know of that; empty where it has no such
/// joint.
[[nodiscard]] std::string words_of_sensors(const Log& log);

}  // namespace offnominal::desk
