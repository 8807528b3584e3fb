#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>
#include <offnominal/model/effects/friction.hpp>
#include <offnominal/model/sine_cosine.hpp>

// Effects of the drive, of springs and of the surroundings that act at the joint.

namespace offnominal::effects {

struct TorqueOffset {
  static constexpr EffectKind kKind = EffectKind::kTorqueOffset;
  static constexpr const char* kName = "torque_offset";
  static constexpr const char* kFormula = "level";
  static constexpr const char* kWords = "a constant torque";
  static constexpr const char* kMotionHint = "rest at several positions";
  static constexpr EffectTraits kTraits{.acts_at_rest = true, .needs_no_motion = true};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "constant torque, such as a bias of the torque measurement"},
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& /*at*/) {
    return p[0];
  }
};

struct JointStiffness {
  static constexpr EffectKind kKind = EffectKind::kJointStiffness;
  static constexpr const char* kName = "joint_stiffness";
  static constexpr const char* kFormula = "stiffness * (q - rest_position)";
  static constexpr const char* kWords = "a spring or cable that pulls to a rest position";
  static constexpr const char* kMotionHint = "move over the whole range, slowly";
  static constexpr EffectTraits kTraits{.acts_at_rest = true};
  static constexpr std::array<ParameterInfo, 2> kParameters{{
      {"stiffness", Quantity::kEffortPerPosition, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque per displacement from the rest position"},
      {"rest_position", Quantity::kPosition, ParameterRole::kShape, -kAny, kAny, false, 0,
       "position without spring torque"},
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    return p[0] * (at.q - p[1]);
  }
};

// Torque that repeats with position: `order` periods per turn (per m on a prismatic joint).
struct CoggingTorque {
  static constexpr EffectKind kKind = EffectKind::kCoggingTorque;
  static constexpr const char* kName = "cogging_torque";
  static constexpr const char* kFormula =
      "sine * sin(k q) + cosine * cos(k q), k = order (revolute) or 2 pi order (prismatic)";
  static constexpr const char* kWords = "a torque ripple that repeats with position";
  static constexpr const char* kMotionHint = "move slowly over several periods";
  static constexpr EffectTraits kTraits{.acts_at_rest = true, .is_before_sensor = true};
  static constexpr std::array<ParameterInfo, 3> kParameters{{
      {"sine", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0, "sine amplitude"},
      {"cosine", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "cosine amplitude"},
      {"order", Quantity::kCyclesPerPosition, ParameterRole::kShape, 1e-9, kAny, true, 0,
       "periods per turn, or per metre"},
  }};
  // parameters[3] holds k, set by the model from `order` and the joint's type.
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    const Scalar phase = p[3] * at.q;
    const SineCosine<Scalar> wave = sine_cosine(phase);
    return p[0] * wave.sine + p[1] * wave.cosine;
  }
  template <typename Scalar>
  static void prepare(std::array<Scalar, kMaxEffectParameters>& p, JointType type) {
    p[3] = type == JointType::kRevolute ? p[2] : p[2] * 2 * std::numbers::pi_v<Scalar>;
  }
};

struct PeriodicDisturbance {
  static constexpr EffectKind kKind = EffectKind::kPeriodicDisturbance;
  static constexpr const char* kName = "periodic_disturbance";
  static constexpr const char* kFormula = "sine * sin(frequency t) + cosine * cos(frequency t)";
  static constexpr const char* kWords = "a disturbance that repeats in time";
  static constexpr const char* kMotionHint = "record for longer";
  static constexpr EffectTraits kTraits{
      .acts_at_rest = true, .counts_time = true, .needs_no_motion = true};
  static constexpr std::array<ParameterInfo, 3> kParameters{{
      {"sine", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0, "sine amplitude"},
      {"cosine", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "cosine amplitude"},
      {"frequency", Quantity::kAngularFrequency, ParameterRole::kShape, 1e-9, kAny, true, 0,
       "angular frequency in time"},
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    double phase = static_cast<double>(p[2]) * at.time_s;
    // A float keeps what is left of the last turn, not the phase after months.
    constexpr double kTurn = 2 * std::numbers::pi;
    if constexpr (sizeof(Scalar) < sizeof(double)) phase -= kTurn * std::floor(phase * (1 / kTurn));
    const SineCosine<Scalar> wave = sine_cosine(static_cast<Scalar>(phase));
    return p[0] * wave.sine + p[1] * wave.cosine;
  }
};

}  // namespace offnominal::effects
