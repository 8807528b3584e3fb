#pragma once

#include <array>
#include <offnominal/model/effects/friction.hpp>

// Effects between motor and link: the position that is measured is the motor's, and the link is not
// where the motor is.

namespace offnominal::effects {

// Linear between transmitted torque and displacement.
struct JointElasticity {
  static constexpr EffectKind kKind = EffectKind::kJointElasticity;
  static constexpr const char* kName = "joint_elasticity";
  static constexpr const char* kFormula = "link at q - (transmitted torque) / stiffness";
  static constexpr const char* kWords = "a transmission that gives way under torque";
  static constexpr const char* kMotionHint = "accelerate hard at several frequencies";
  static constexpr EffectTraits kTraits{};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"stiffness", Quantity::kEffortPerPosition, ParameterRole::kShape, 1e-9, kAny, true, 0,
       "transmitted torque per displacement of motor against link"},
  }};
};

// Play: where the transmitted torque changes its sign the link is free until the other side is
// reached.
struct Backlash {
  static constexpr EffectKind kKind = EffectKind::kBacklash;
  static constexpr const char* kName = "backlash";
  static constexpr const char* kFormula =
      "link free within width behind the motor, without rebound";
  static constexpr const char* kWords = "play in the transmission";
  static constexpr const char* kMotionHint =
      "let the transmitted torque change its sign slowly and often";
  static constexpr EffectTraits kTraits{};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"width",
       Quantity::kDistance,
       ParameterRole::kShape,
       1e-9,
       kAny,
       true,
       0,
       "way of the motor between the two sides, the link held",
       {0.0005, 0.05}},
  }};
};

}  // namespace offnominal::effects
