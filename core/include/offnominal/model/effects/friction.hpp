#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <offnominal/exponential.hpp>
#include <offnominal/model/effect.hpp>
#include <offnominal/model/smooth_sign.hpp>

namespace offnominal::effects {

inline constexpr double kAny = std::numeric_limits<double>::max();

// The velocity at which the smoothed sign has reached 0.76 of its final value.
inline constexpr ParameterInfo kSmoothing{"smoothing",
                                          Quantity::kVelocity,
                                          ParameterRole::kShape,
                                          1e-9,
                                          kAny,
                                          false,
                                          0.01,
                                          "velocity over which the sign is smoothed"};

// The same parameter, looked for between these shares of what the motion shows.
[[nodiscard]] constexpr ParameterInfo searched(ParameterInfo parameter, double from, double to) {
  parameter.searched = {from, to};
  return parameter;
}

struct ViscousFriction {
  static constexpr EffectKind kKind = EffectKind::kViscousFriction;
  static constexpr const char* kName = "viscous_friction";
  static constexpr const char* kFormula = "coefficient * dq";
  static constexpr const char* kWords = "friction proportional to speed";
  static constexpr const char* kMotionHint = "move at several constant speeds";
  static constexpr EffectTraits kTraits{.is_friction = true,
                                        .part = FrictionPart::kPerVelocity,
                                        .sign = CoefficientSign::kPositive,
                                        .follows = EffectVariable::kVelocity,
                                        .every_drive_has = true,
                                        .may_change = true};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"coefficient", Quantity::kEffortPerVelocity, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque per velocity"},
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    return p[0] * at.dq;
  }
};

struct CoulombFriction {
  static constexpr EffectKind kKind = EffectKind::kCoulombFriction;
  static constexpr const char* kName = "coulomb_friction";
  static constexpr const char* kFormula = "level * tanh(dq / smoothing)";
  static constexpr const char* kWords = "dry friction, independent of speed";
  static constexpr const char* kMotionHint = "reverse often at moderate speed";
  static constexpr EffectTraits kTraits{.is_friction = true,
                                        .part = FrictionPart::kDry,
                                        .sign = CoefficientSign::kPositive,
                                        .follows = EffectVariable::kVelocity,
                                        .every_drive_has = true,
                                        .may_change = true};
  static constexpr std::array<ParameterInfo, 2> kParameters{{
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque against the motion, whatever its speed"},
      searched(kSmoothing, 0.001, 0.05),
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    return p[0] * smooth_sign(at.dq, p[1]);
  }
};

// Half the difference between the friction of forward and of backward motion. With Coulomb and
// viscous friction beside it the two directions have independent levels and slopes:
// level+ = level + asymmetry.level, level- = level - asymmetry.level, and likewise the slopes.
struct FrictionAsymmetry {
  static constexpr EffectKind kKind = EffectKind::kFrictionAsymmetry;
  static constexpr const char* kName = "friction_asymmetry";
  static constexpr const char* kFormula =
      "level * s^2 + coefficient * dq * s, s = tanh(dq / smoothing)";
  static constexpr const char* kWords = "friction that differs between the two directions";
  static constexpr const char* kMotionHint =
      "move at several speeds in both directions, with rests in between";
  static constexpr EffectTraits kTraits{.follows = EffectVariable::kVelocity,
                                        .passes_for_friction = true,
                                        .needs_both_directions = true};
  static constexpr std::array<ParameterInfo, 3> kParameters{{
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "half the difference of the Coulomb levels of the two directions"},
      {"coefficient", Quantity::kEffortPerVelocity, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "half the difference of the viscous slopes of the two directions"},
      kSmoothing,
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    const Scalar sign = smooth_sign(at.dq, p[2]);
    return sign * (p[0] * sign + p[1] * at.dq);
  }
};

// What friction at very low speed has above the Coulomb level, Gaussian form.
// Source: B. Armstrong-Helouvry et al., Automatica 30(7), 1994, with exponent 2.
struct StribeckFriction {
  static constexpr EffectKind kKind = EffectKind::kStribeckFriction;
  static constexpr const char* kName = "stribeck_friction";
  static constexpr const char* kFormula =
      "level * exp(-(dq / stribeck_velocity)^2) * tanh(dq / smoothing)";
  static constexpr const char* kWords =
      "extra dry friction near standstill that fades as the joint speeds up";
  static constexpr const char* kMotionHint =
      "hold at least four low speeds between a third and three times the Stribeck velocity";
  static constexpr EffectTraits kTraits{.is_friction = true,
                                        .part = FrictionPart::kAtRest,
                                        .sign = CoefficientSign::kMostlyPositive,
                                        .follows = EffectVariable::kVelocity,
                                        .passes_for_friction = true};
  static constexpr std::array<ParameterInfo, 3> kParameters{{
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "static friction minus Coulomb friction"},
      {"stribeck_velocity",
       Quantity::kVelocity,
       ParameterRole::kShape,
       1e-9,
       kAny,
       true,
       0,
       "velocity at which the excess has fallen to 1/e",
       // At the low end it is the width of the sign.
       {0.015, 0.4, OtherEffectAt::kLowest}},
      kSmoothing,
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    const Scalar ratio = at.dq / p[1];
    return p[0] * exponential(-ratio * ratio) * smooth_sign(at.dq, p[2]);
  }
};

struct QuadraticFriction {
  static constexpr EffectKind kKind = EffectKind::kQuadraticFriction;
  static constexpr const char* kName = "quadratic_friction";
  static constexpr const char* kFormula = "coefficient * dq * |dq|";
  static constexpr const char* kWords = "drag that grows with the square of speed";
  static constexpr const char* kMotionHint = "use a speed range of more than 3 to 1";
  static constexpr EffectTraits kTraits{
      .is_friction = true, .follows = EffectVariable::kVelocity, .passes_for_friction = true};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"coefficient", Quantity::kEffortPerVelocitySquared, ParameterRole::kLinear, -kAny, kAny,
       true, 0, "torque per squared velocity, against the motion"},
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    return p[0] * at.dq * Eigen::numext::abs(at.dq);
  }
};

// What a cold joint has above the Coulomb and viscous friction of the warm one. A run starts cold.
struct TemperatureDrift {
  static constexpr EffectKind kKind = EffectKind::kTemperatureDrift;
  static constexpr const char* kName = "temperature_drift";
  static constexpr const char* kFormula =
      "exp(-t / time_constant) * (level * tanh(dq / smoothing) + coefficient * dq)";
  static constexpr const char* kWords = "friction that changes while the joint warms up";
  static constexpr const char* kMotionHint =
      "repeat the same motion from a cold start for several time constants";
  static constexpr EffectTraits kTraits{
      .is_friction = true, .counts_time = true, .passes_for_friction = true};
  static constexpr std::array<ParameterInfo, 4> kParameters{{
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "excess of the Coulomb level at the start"},
      {"coefficient", Quantity::kEffortPerVelocity, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "excess of the viscous slope at the start"},
      // What has not faded by the end of a recording is friction that stays: longer, this effect
      // would stand for Coulomb and viscous friction at once.
      {"time_constant",
       Quantity::kTime,
       ParameterRole::kShape,
       1e-9,
       kAny,
       true,
       0,
       "time after which the excess has fallen to 1/e",
       {1.0 / 12, 0.75, OtherEffectAt::kHighest}},
      kSmoothing,
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    return exponential(static_cast<Scalar>(-at.time_s) / p[2]) *
           (p[0] * smooth_sign(at.dq, p[3]) + p[1] * at.dq);
  }
};

// Friction that the motion of another joint causes at this one: a belt, a differential, a wrist.
struct JointCoupling {
  static constexpr EffectKind kKind = EffectKind::kJointCoupling;
  static constexpr const char* kName = "joint_coupling";
  static constexpr const char* kFormula =
      "coefficient * dq_k + level * tanh(dq_k / smoothing), k = source_joint";
  static constexpr const char* kWords = "friction from the motion of another joint";
  static constexpr const char* kMotionHint = "move one joint at a time";
  static constexpr EffectTraits kTraits{.passes_for_friction = true};
  static constexpr std::array<ParameterInfo, 4> kParameters{{
      {"coefficient", Quantity::kEffortPerVelocity, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque per velocity of the other joint"},
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque by the direction of the other joint"},
      {"source_joint", Quantity::kJointNumber, ParameterRole::kShape, 1, kAny, true, 0,
       "the other joint, from 1"},
      kSmoothing,
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    return p[0] * at.source_dq + p[1] * smooth_sign(at.source_dq, p[3]);
  }
};

}  // namespace offnominal::effects
