#pragma once

#include <tinyxml2.h>

#include <array>
#include <span>
#include <string>
#include <vector>

#include "exchange/export_robot.hpp"
#include "exchange/rigid_body.hpp"

// What the writers of URDF and MJCF share.

namespace offnominal::desk::exchange {

/// A joint with its link as a simulator has it.
struct ExportedJoint {
  std::string name;  // of one line, differs from every other's
  RigidBody body;    // payloads and other masses included
  double damping = 0;
  double friction = 0;
  double armature = 0;
  double stiffness = 0;
  double rest_position = 0;
};

/// Which effects a format has a place for, beside masses, damping and friction.
struct FormatTraits {
  const char* name;
  const char* taken;  // a name that what is written has already, beside the joints'
  bool has_armature = false;
  bool has_springs = false;
};

/// The joints; `result` takes what changed and what is not carried.
[[nodiscard]] std::vector<ExportedJoint> exported_joints(const RobotDescription& robot,
                                                         const FormatTraits& format,
                                                         ExportedRobot& result);

/// The tensor; thin and small bodies, of which simulators take none, get moments that no torque
/// shows: 1e-12 kg m^2, or 1e-9 of the largest.
[[nodiscard]] Eigen::Matrix3d loadable_inertia(const RigidBody& body);

/// Numbers between blanks, as many digits each as it takes to read the same ones back.
[[nodiscard]] std::string numbers(std::span<const double> values);

/// The comment that a written file begins with.
[[nodiscard]] std::string head_comment(const ExportedRobot& result, const std::string& verb,
                                       const std::string& robot_file);

}  // namespace offnominal::desk::exchange
