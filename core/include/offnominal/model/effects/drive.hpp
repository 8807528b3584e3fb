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
  static constexpr EffectTraits kTraits{
      .acts_at_rest = true, .needs_no_motion = true, .may_change = true};
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
  static constexpr EffectTraits kTraits{.acts_at_rest = true, .follows = EffectVariable::kPosition};
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
  static constexpr EffectTraits kTraits{
      .acts_at_rest = true, .is_before_sensor = true, .follows = EffectVariable::kPosition};
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

// A smooth torque over the position that nothing else describes: a counterweight, a gas spring, a
// cable. A clamped cubic B-spline of three equal pieces over `range`, constant outside of it; its
// torques stay between the smallest and the largest of the six. Source: C. de Boor, A Practical
// Guide to Splines, 2001, chapter X.
struct PositionTorque {
  static constexpr EffectKind kKind = EffectKind::kPositionTorque;
  static constexpr const char* kName = "position_torque";
  static constexpr const char* kFormula =
      "cubic B-spline of torque_1 to torque_6 over q from begin to begin + range, constant outside";
  static constexpr const char* kWords =
      "a smooth torque over the position, as of a counterweight, a gas spring or a cable";
  static constexpr const char* kMotionHint =
      "move over the whole range, slowly, the other joints in several poses";
  static constexpr EffectTraits kTraits{
      .acts_at_rest = true, .follows = EffectVariable::kPosition, .has_any_shape = true};
  static constexpr std::array<ParameterInfo, 8> kParameters{{
      {"begin",
       Quantity::kPosition,
       ParameterRole::kShape,
       -kAny,
       kAny,
       true,
       0,
       "position where the curve begins",
       {},
       true},
      {"range",
       Quantity::kDistance,
       ParameterRole::kShape,
       1e-9,
       kAny,
       true,
       0,
       "how far the curve reaches from there",
       {},
       true},
      {"torque_1", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque where the curve begins, and before"},
      {"torque_2", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque that draws the curve to itself at 1/9 of the range"},
      {"torque_3", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "the same at 1/3 of the range"},
      {"torque_4", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "the same at 2/3 of the range"},
      {"torque_5", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "the same at 8/9 of the range"},
      {"torque_6", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque where the curve ends, and beyond"},
  }};
  template <typename Scalar>
  static Scalar torque(const std::array<Scalar, kMaxEffectParameters>& p,
                       const JointInstant<Scalar>& at) {
    constexpr std::size_t kFirst = 2;
    constexpr std::size_t kPieces = 3;
    Scalar u = (at.q - p[0]) / p[1] * Scalar(kPieces);
    if (u < 0) u = 0;
    if (u > Scalar(kPieces)) u = Scalar(kPieces);
    // Compared, not converted: of a position that is no number there is no piece to convert to.
    const std::size_t piece = u >= 2 ? 2 : u >= 1 ? 1 : 0;
    const auto knot = [](std::size_t i) {
      return Scalar(i < kFirst ? 0 : i - kFirst > kPieces ? kPieces : i - kFirst);
    };
    std::array<Scalar, 4> d{p[kFirst + piece], p[kFirst + piece + 1], p[kFirst + piece + 2],
                            p[kFirst + piece + 3]};
    for (std::size_t round = 1; round < d.size(); ++round) {
      for (std::size_t j = d.size() - 1; j >= round; --j) {
        const Scalar low = knot(piece + j - 1);
        const Scalar share = (u - low) / (knot(piece + j + 3 - round) - low);
        d[j] = (1 - share) * d[j - 1] + share * d[j];
      }
    }
    return d[3];
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
