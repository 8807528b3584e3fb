#pragma once

#include <Eigen/Core>
#include <array>
#include <offnominal/exponential.hpp>
#include <offnominal/model/effects/friction.hpp>

// Effects with a memory: what they do follows from how the joint came to where it is, or from what
// the drive was told before. effect_memory.hpp keeps what they remember.

namespace offnominal::effects {

// Friction that builds up over a distance after each reversal, as the contacts between two surfaces
// are stretched before they slide. Source: P. R. Dahl, AIAA Journal 14(12), 1976, exponent 1.
struct Hysteresis {
  static constexpr EffectKind kKind = EffectKind::kHysteresis;
  static constexpr const char* kName = "hysteresis";
  static constexpr const char* kFormula = "level * z, dz/dq = (1 - z sgn(dq)) / width";
  static constexpr const char* kWords =
      "friction that builds up over a distance after each reversal";
  static constexpr const char* kMotionHint = "make many small reversals";
  static constexpr EffectTraits kTraits{
      .is_friction = true, .sign = CoefficientSign::kPositive, .passes_for_friction = true};
  static constexpr std::array<ParameterInfo, 2> kParameters{{
      {"level", Quantity::kEffort, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "torque against the motion, far from a reversal"},
      {"width",
       Quantity::kDistance,
       ParameterRole::kShape,
       1e-9,
       kAny,
       true,
       0,
       "way in which the distance to that torque falls to 1/e",
       {0.006, 0.3}},
  }};
  // z after a way without a reversal, exactly. A run starts with z = 0.
  template <typename Scalar>
  static Scalar next_state(const std::array<Scalar, kMaxEffectParameters>& p, Scalar z,
                           Scalar travelled) {
    const Scalar end = travelled < 0 ? Scalar(-1) : Scalar(1);
    return end + (z - end) * exponential(-Eigen::numext::abs(travelled) / p[1]);
  }
  template <typename Scalar>
  static Scalar torque_of_state(const std::array<Scalar, kMaxEffectParameters>& p, Scalar z) {
    return p[0] * z;
  }
};

// A drive that executes its torque late. What it was told before the run began is what the run's
// first sample says.
struct TimeDelay {
  static constexpr EffectKind kKind = EffectKind::kTimeDelay;
  static constexpr const char* kName = "time_delay";
  static constexpr const char* kFormula = "torque(t) is logged `delay` before it acts";
  static constexpr const char* kWords = "a drive that executes its torque late";
  static constexpr const char* kMotionHint =
      "accelerate at two frequencies at least, the higher the better";
  static constexpr EffectTraits kTraits{};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"delay", Quantity::kTime, ParameterRole::kLinear, 0, kAny, true, 0,
       "time from the logged torque to the one that acts"},
  }};
  template <typename Scalar>
  static Scalar delay_s(const std::array<Scalar, kMaxEffectParameters>& p) {
    return p[0];
  }
};

}  // namespace offnominal::effects
