#pragma once

#include <array>
#include <offnominal/model/effects/friction.hpp>

// Effects that change the inertia of the chain. The model takes them up once, when it is made; they
// cost nothing per tick.

namespace offnominal::effects {

// A point mass in the frame of a link.
template <typename Scalar>
struct PointMass {
  Scalar mass_kg{};
  std::array<Scalar, 3> position_m{};
};

struct RotorInertia {
  static constexpr EffectKind kKind = EffectKind::kRotorInertia;
  static constexpr const char* kName = "rotor_inertia";
  static constexpr const char* kFormula = "inertia * ddq";
  static constexpr const char* kWords = "the inertia of rotor and gear";
  static constexpr const char* kMotionHint = "accelerate hard, link by link";
  static constexpr EffectTraits kTraits{.is_before_sensor = true};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"inertia", Quantity::kReflectedInertia, ParameterRole::kLinear, 0, kAny, true, 0,
       "inertia of rotor and gear as seen at the joint"},
  }};
  template <typename Scalar>
  static Scalar reflected_inertia(const std::array<Scalar, kMaxEffectParameters>& p) {
    return p[0];
  }
};

// A mass carried by a link, by default at the origin of the link's frame.
struct TipPayload {
  static constexpr EffectKind kKind = EffectKind::kTipPayload;
  static constexpr const char* kName = "tip_payload";
  static constexpr const char* kFormula = "inverse dynamics of a point mass at (x, y, z)";
  static constexpr const char* kWords = "a payload at the tip";
  static constexpr const char* kMotionHint = "hold several poses under gravity";
  static constexpr EffectTraits kTraits{.acts_at_rest = true, .may_change = true};
  static constexpr std::array<ParameterInfo, 4> kParameters{{
      {"mass", Quantity::kMass, ParameterRole::kLinear, -kAny, kAny, true, 0, "carried mass"},
      {"x", Quantity::kLength, ParameterRole::kShape, -kAny, kAny, false, 0, "in the link's frame"},
      {"y", Quantity::kLength, ParameterRole::kShape, -kAny, kAny, false, 0, "in the link's frame"},
      {"z", Quantity::kLength, ParameterRole::kShape, -kAny, kAny, false, 0, "in the link's frame"},
  }};
  template <typename Scalar>
  static PointMass<Scalar> point_mass(const std::array<Scalar, kMaxEffectParameters>& p,
                                      const std::array<Scalar, 3>& /*centre_of_mass_m*/) {
    return {p[0], {p[1], p[2], p[3]}};
  }
};

// A change of a link's mass at the link's own centre of mass.
struct LinkMass {
  static constexpr EffectKind kKind = EffectKind::kLinkMass;
  static constexpr const char* kName = "link_mass";
  static constexpr const char* kFormula = "inverse dynamics of a point mass at the centre of mass";
  static constexpr const char* kWords = "a link of another mass";
  static constexpr const char* kMotionHint = "hold several poses under gravity";
  static constexpr EffectTraits kTraits{.acts_at_rest = true};
  static constexpr std::array<ParameterInfo, 1> kParameters{{
      {"mass", Quantity::kMass, ParameterRole::kLinear, -kAny, kAny, true, 0,
       "mass added to the link"},
  }};
  template <typename Scalar>
  static PointMass<Scalar> point_mass(const std::array<Scalar, kMaxEffectParameters>& p,
                                      const std::array<Scalar, 3>& centre_of_mass_m) {
    return {p[0], centre_of_mass_m};
  }
};

}  // namespace offnominal::effects
