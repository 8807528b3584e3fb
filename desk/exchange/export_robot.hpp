#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/robot.hpp"

// A robot file as what simulators read: rigid bodies, damping, dry friction, and what else the
// format knows. What it does not know is named, one by one.

namespace offnominal::desk::exchange {

struct ExportedRobot {
  std::string text;
  std::vector<std::string> changed;      // what stands there in another form
  std::vector<std::string> not_carried;  // what the format has no place for
};

/// URDF: viscous friction as damping, Coulomb friction as friction. Gravity in another direction
/// than -z tilts the base on a link `world`.
[[nodiscard]] ExportedRobot export_urdf(const RobotDescription& robot,
                                        const std::string& robot_file);

/// MJCF for MuJoCo 2.2 and later: damping, friction loss, armature (rotor inertia) and springs of
/// the joints, a motor each, and capsules to see it by, which touch nothing and weigh nothing.
[[nodiscard]] ExportedRobot export_mjcf(const RobotDescription& robot,
                                        const std::string& robot_file);

}  // namespace offnominal::desk::exchange
