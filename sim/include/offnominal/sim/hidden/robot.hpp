// The hidden robot: every number of its physics. What is not there is 0, so that each effect can be
// read, set and tested by itself.
#pragma once

#include <array>
#include <limits>

#include "offnominal/sim/hidden/joint_effects.hpp"
#include "offnominal/sim/hidden/planar_arm.hpp"

namespace offnominal::sim::hidden {

/// What the drive makes of a logged torque.
struct JointDrive {
  double scale = 1.0;
  double delay_s = 0.0;
  double saturation_onset_nm = std::numeric_limits<double>::infinity();
  double saturation_slope = 1.0;  ///< of the torque given above the onset, per logged torque
};

/// Between motor and link. Rigid where both stiffness and gap are 0.
struct JointTransmission {
  double rotor_inertia_kg_m2 = 0.05;  ///< seen at the joint, > 0 where the joint is not rigid
  double stiffness_nm_rad = 0.0;
  double damping_nm_s_rad = 0.0;
  double gap_rad = 0.0;  ///< full width
  [[nodiscard]] bool rigid() const { return stiffness_nm_rad == 0.0; }
};

struct RobotJoint {
  JointFriction friction;
  JointDrive drive;
  JointTransmission transmission;
  JointLoads loads;
};

/// Someone pushes on a link: a half sine in time.
struct Contact {
  int joint = 0;
  double start_s = 0.0;
  double duration_s = 0.0;
  double peak_nm = 0.0;
};

struct Robot {
  std::array<RigidLink, 2> links;
  double tip_mass_kg = 0.0;
  double gravity_m_s2 = 9.81;
  std::array<RobotJoint, 2> joints;
  double contact_peak_nm = 0.0;  ///< of transient contacts, on contact_joint; 0 for none
  int contact_joint = 0;

  [[nodiscard]] PlanarArm arm() const { return {links, gravity_m_s2, tip_mass_kg}; }
};

}  // namespace offnominal::sim::hidden
