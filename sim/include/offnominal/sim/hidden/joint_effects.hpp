// What may act at a joint of the hidden robot beside the arm, and may be hidden: which effects
// there are, the numbers of each, and its equation. What is not there is 0, so that each effect can
// be read, set and tested by itself. A new effect is its number here and its row in
// effect_table.cpp.
#pragma once

#include <algorithm>
#include <cmath>

namespace offnominal::sim::hidden {

/// Effects that the analysis has a candidate for. The order is that of hiding: what builds on
/// another's numbers comes after it. A new one comes last: its number is part of its seed.
enum class HiddenEffect {
  kCoulombFriction,
  kViscousFriction,
  kQuadraticFriction,
  kStribeckFriction,
  kFrictionAsymmetry,
  kLoadDependentFriction,
  kHysteresis,
  kTorqueOffset,
  kTorqueScale,
  kRotorInertia,
  kLinkMass,
  kTipPayload,
  kCoggingTorque,
  kJointStiffness,
  kJointElasticity,
  kBacklash,
  kTimeDelay,
  kPeriodicDisturbance,
  kJointCoupling,
  kTemperatureDrift,
  kGearLoss,
  kPositionTorque,
};

/// Effects that the analysis has no candidate for.
enum class OutsideEffect {
  kNone,
  kEndStop,   ///< one-sided spring beyond an angle that the motion reaches
  kWornSpot,  ///< more friction in a narrow range of positions
  kDragBand,  ///< more friction in a narrow band of speeds, a rubbing fan or a howling belt
  kMagneticSaturation,  ///< the drive gives less than it logs beyond a torque
  kTransientContact,    ///< someone pushes, for a moment
};

/// The motor's side of a joint at an instant.
struct MotorSide {
  double q = 0.0;             ///< rad
  double dq = 0.0;            ///< rad/s
  double other_dq = 0.0;      ///< of the other joint, rad/s
  double stretch = 0.0;       ///< of the friction's bristle, of its width
  double belt_stretch = 0.0;  ///< of the belt's bristle
  double gear_load_nm = 0.0;  ///< torque through the gear
  double t_s = 0.0;           ///< since the start of the run
};

/// 1 at the centre, 1/e at the half width.
inline double bump(double x, double centre, double half_width) {
  const double d = (x - centre) / half_width;
  return std::exp(-d * d);
}

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
  double driving_loss = 0.0;           ///< per gear load, where the drive moves the load
  double driven_loss = 0.0;            ///< per gear load, where the load moves the drive
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

  /// Share of what a cold joint has in excess that is left t_s after the start.
  [[nodiscard]] double cold(double t_s) const {
    const bool warms = cold_coulomb_nm != 0.0 || cold_viscous_nm_s_rad != 0.0;
    return warms ? std::exp(-t_s / warming_s) : 0.0;
  }

  /// What the bristle bears in steady sliding, N m, >= 0.
  [[nodiscard]] double sliding_level(const MotorSide& at) const {
    double level =
        coulomb_nm + per_load * std::abs(at.gear_load_nm) + cold(at.t_s) * cold_coulomb_nm;
    if (stribeck_nm != 0.0) level += stribeck_nm * bump(at.dq, 0.0, stribeck_velocity_rad_s);
    if (worn_nm != 0.0) level += worn_nm * bump(at.q, worn_position_rad, worn_half_width_rad);
    if (band_nm != 0.0) {
      level += band_nm * bump(std::abs(at.dq), band_speed_rad_s, band_half_width_rad_s);
    }
    // By the bristle's side, not the velocity's: the torque stays continuous where the joint
    // sticks.
    level += std::abs(at.gear_load_nm) *
             (at.gear_load_nm * at.stretch > 0.0 ? driving_loss : driven_loss);
    level += std::copysign(coulomb_asymmetry_nm, coulomb_asymmetry_nm * at.stretch);
    return std::max(0.0, level);
  }

  /// What no bristle bears, N m.
  [[nodiscard]] double viscous_torque(const MotorSide& at) const {
    const double viscous = viscous_nm_s_rad + cold(at.t_s) * cold_viscous_nm_s_rad +
                           (at.dq > 0.0 ? 1.0 : -1.0) * viscous_asymmetry_nm_s_rad;
    return viscous * at.dq + quadratic_nm_s2_rad2 * at.dq * std::abs(at.dq);
  }
};

/// A gas spring between a foot on the link before and a pin on the joint's own link: a triangle
/// with the joint's axis, whose third side is the spring. It pushes, the more the shorter it is.
struct GasSpring {
  double force_n = 0.0;          ///< of the gas at its largest volume
  double foot_m = 0.4;           ///< from the axis
  double pin_m = 0.25;           ///< from the axis
  double dead_centre_rad = 0.0;  ///< position at which the pin is next to the foot
  double squeezed = 0.4;         ///< share of the volume that is gone there

  /// What the drive has to supply with the link at q, N m.
  [[nodiscard]] double torque(double q) const {
    const double angle = q - dead_centre_rad;
    const double length =
        std::sqrt(foot_m * foot_m + pin_m * pin_m - 2.0 * foot_m * pin_m * std::cos(angle));
    const double extended = (length - (foot_m - pin_m)) / (2.0 * pin_m);  // 0 to 1: foot_m > pin_m
    constexpr double kPolytropic = 1.2;
    const double force = force_n * std::pow(1.0 - squeezed * (1.0 - extended), -kPolytropic);
    const double lever_m = foot_m * pin_m * std::sin(angle) / length;
    return -force * lever_m;
  }
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
  GasSpring gas_spring;

  /// On the motor's side, N m.
  [[nodiscard]] double on_motor(const MotorSide& at) const {
    double torque = offset_nm + coupling_nm_s_rad * at.other_dq + belt_nm * at.belt_stretch;
    if (cogging_nm != 0.0)
      torque += cogging_nm * std::sin(cogging_order * at.q + cogging_phase_rad);
    return torque;
  }

  /// On the link's side, at its position, N m.
  [[nodiscard]] double on_link(double q, double t_s) const {
    double torque = spring_nm_rad * (q - spring_rest_rad);
    if (gas_spring.force_n != 0.0) torque += gas_spring.torque(q);
    if (periodic_nm != 0.0)
      torque += periodic_nm * std::sin(periodic_rad_s * t_s + periodic_phase_rad);
    const double beyond = stop_side * (q - stop_position_rad);
    if (beyond > 0.0) torque += stop_side * stop_nm_rad * beyond;
    return torque;
  }
};

}  // namespace offnominal::sim::hidden
