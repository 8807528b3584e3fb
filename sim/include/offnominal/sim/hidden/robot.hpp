// The hidden robot: every number of its physics. What is not there is 0, so that each effect can be
// read, set and tested by itself.
#pragma once

#include <array>
#include <limits>

#include "offnominal/sim/hidden/planar_arm.hpp"

namespace offnominal::sim::hidden {

/// Friction of motor and gear.
struct JointFriction {
  double coulomb_nm = 0.0;
  double viscous_nm_s_rad = 0.0;
  double width_rad = 1e-4;  ///< pre-sliding distance
  double quadratic_nm_s2_rad2 = 0.0;
  double stribeck_nm = 0.0;  ///< static less Coulomb
  double stribeck_velocity_rad_s = 0.1;
  double coulomb_asymmetry_nm = 0.0;  ///< half the difference of the directions, + less -
  double viscous_asymmetry_nm_s_rad = 0.0;
  double per_load = 0.0;               ///< friction per magnitude of the torque through the gear
  double cold_coulomb_nm = 0.0;        ///< excess at the start of a run
  double cold_viscous_nm_s_rad = 0.0;  ///< excess at the start of a run
  double warming_s = 10.0;             ///< time constant of its decay
  double soft_level_nm = 0.0;          ///< second, wide bristle: hysteresis
  double soft_width_rad = 0.1;
  double worn_nm = 0.0;  ///< excess at the worn spot
  double worn_position_rad = 0.0;
  double worn_half_width_rad = 0.1;
  double band_nm = 0.0;  ///< excess in a band of speeds
  double band_speed_rad_s = 1.0;
  double band_half_width_rad_s = 0.2;
};

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

/// Torques beside gravity and friction. All are what the drive has to supply.
struct JointLoads {
  double offset_nm = 0.0;
  double cogging_nm = 0.0;  ///< amplitude
  double cogging_order = 6.0;
  double cogging_phase_rad = 0.0;  ///< torque = amplitude sin(order q + phase)
  double spring_nm_rad = 0.0;
  double spring_rest_rad = 0.0;
  double periodic_nm = 0.0;  ///< amplitude
  double periodic_rad_s = 6.0;
  double periodic_phase_rad = 0.0;  ///< torque = amplitude sin(frequency t + phase)
  double coupling_nm_s_rad = 0.0;   ///< per velocity of the other joint
  double belt_nm = 0.0;             ///< Coulomb level of a belt that the other joint drags along
  double stop_nm_rad = 0.0;         ///< stiffness of the end stop
  double stop_position_rad = 0.0;
  double stop_side = 1.0;  ///< 1: acts above the position, -1: below
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
