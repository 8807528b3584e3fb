#pragma once

#include <Eigen/Core>
#include <array>
#include <offnominal/model/effects/friction.hpp>

// Effects on the way of the torque from the drive to the load: they scale what passes, where the
// other torque effects add to it. torque_path.hpp says how they act together.

namespace offnominal::effects {

// What a drive supplies beside the load: by_size |load| + by_load load. The first is friction of
// either direction of power, the second what it is more where the drive moves the load than where
// the load moves the drive.
template <typename Scalar>
struct LoadFriction {
  Scalar by_size{};
  Scalar by_load{};
};

// Friction of a gear whose teeth are pressed together by what they transmit.
// Source: P. Hamon, M. Gautier, P. Garrec, IROS 2010 (dry friction that depends on load and
// velocity), with the reflected inertia counted as load, as torque_path.hpp explains.
struct LoadDependentFriction {
  static constexpr EffectKind kKind = EffectKind::kLoadDependentFriction;
  static constexpr const char* kName = "load_dependent_friction";
  static constexpr const char* kFormula = "factor * |load torque| * tanh(dq / smoothing)";
  static constexpr const char* kWords = "friction that grows with the torque transmitted";
  static constexpr const char* kMotionHint = "reverse at poses with little and with much load";
  static constexpr EffectTraits kTraits{.is_friction = true,
                                        .is_before_sensor = true,
                                        .sign = CoefficientSign::kPositive,
                                        .passes_for_friction = true};
  // At 1 a joint that its load drives would lock, and no acceleration would follow from the torque.
  static constexpr double kMostFactor = 0.95;
  static constexpr std::array<ParameterInfo, 2> kParameters{{
      {"factor", Quantity::kRatio, ParameterRole::kLinear, 0, kMostFactor, true, 0,
       "friction per torque that passes through the gear"},
      kSmoothing,
  }};
  template <typename Scalar>
  static LoadFriction<Scalar> friction_per_load(const std::array<Scalar, kMaxEffectParameters>& p,
                                                const JointInstant<Scalar>& at) {
    return {p[0] * smooth_sign(at.dq, p[1]), Scalar(0)};
  }
  // What it never exceeds where the load moves the drive.
  template <typename Scalar>
  static Scalar most_friction_per_load(const std::array<Scalar, kMaxEffectParameters>& p) {
    return p[0];
  }
};

// A gear that loses a share of what it transmits, another one where the drive moves the load than
// where the load moves the drive. Of a gear with the efficiencies eta and eta_driven the drive
// supplies load / eta or eta_driven load: driving_loss = 1 / eta - 1, driven_loss = 1 - eta_driven.
// Equal losses are LoadDependentFriction. Nothing is lost at standstill or without load; between
// the two directions of a moving joint's power the slope over the load has a kink, and only so does
// the load follow from the torque in closed form. Source: A. Wang, S. Kim, Directional efficiency
// in geared transmissions, ICRA 2015; smooth in the velocity by this file's own w.
struct GearLoss {
  static constexpr EffectKind kKind = EffectKind::kGearLoss;
  static constexpr const char* kName = "gear_loss";
  static constexpr const char* kFormula =
      "|load torque| * s * (driving_loss * (1 + w) + driven_loss * (1 - w)) / 2, "
      "w = s * sgn(load torque), s = tanh(dq / smoothing)";
  static constexpr const char* kWords =
      "a gear whose loss depends on whether it drives or is driven back";
  static constexpr const char* kMotionHint =
      "raise and lower a load at several poses, as often with the load as against it";
  static constexpr EffectTraits kTraits{.is_friction = true,
                                        .is_before_sensor = true,
                                        .sign = CoefficientSign::kPositive,
                                        .passes_for_friction = true};
  static constexpr double kMostDrivingLoss = 2;
  static constexpr std::array<ParameterInfo, 3> kParameters{{
      {"driven_loss", Quantity::kRatio, ParameterRole::kLinear, 0,
       LoadDependentFriction::kMostFactor, true, 0,
       "share of the load torque that is lost where the load moves the drive"},
      {"driving_loss", Quantity::kRatio, ParameterRole::kLinear, 0, kMostDrivingLoss, true, 0,
       "what the drive supplies above the load torque where it moves the load, per load torque"},
      kSmoothing,
  }};
  template <typename Scalar>
  static LoadFriction<Scalar> friction_per_load(const std::array<Scalar, kMaxEffectParameters>& p,
                                                const JointInstant<Scalar>& at) {
    const Scalar sign = smooth_sign(at.dq, p[2]);
    return {sign * (p[1] + p[0]) / 2, sign * sign * (p[1] - p[0]) / 2};
  }
  // by_size - by_load, which is s (sum - s difference) / 2, over s from 0 to 1: it rises to the end
  // unless driving loses more than three times what being driven does.
  template <typename Scalar>
  static Scalar most_friction_per_load(const std::array<Scalar, kMaxEffectParameters>& p) {
    if (!(p[1] > 3 * p[0])) return p[0];
    const Scalar sum = p[1] + p[0];
    return sum * sum / (8 * (p[1] - p[0]));
  }
};

// A wrong torque constant: (1 + error) times the torque that acts is what the drive is told to
// give, and what a log says. A drive that gives (1 + share) times what it is told has error = 1 /
// (1 + share) - 1.
struct TorqueScale {
  static constexpr EffectKind kKind = EffectKind::kTorqueScale;
  static constexpr const char* kName = "torque_scale";
  static constexpr const char* kFormula = "error * (torque of the model)";
  static constexpr const char* kWords = "a wrong torque constant";
  static constexpr const char* kMotionHint = "move with a payload of known mass";
  static constexpr EffectTraits kTraits{
      .acts_at_rest = true, .follows = EffectVariable::kLoad, .may_change = true};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"error", Quantity::kRatio, ParameterRole::kLinear, -0.9, 9, true, 0,
       "logged torque per torque that acts, less 1"},
  }};
  template <typename Scalar>
  static Scalar told_per_given(const std::array<Scalar, kMaxEffectParameters>& p) {
    return 1 + p[0];
  }
};

}  // namespace offnominal::effects
