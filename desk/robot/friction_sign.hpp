#pragma once

#include <offnominal/model/effect.hpp>

namespace offnominal::desk {

/// Whether a parameter is friction that is against the motion at every instant: below zero it would
/// feed energy into the joint, which no friction does.
[[nodiscard]] constexpr bool takes_energy_out(const EffectTraits& traits,
                                              const ParameterInfo& parameter) {
  return parameter.role == ParameterRole::kLinear && traits.is_friction &&
         traits.sign == CoefficientSign::kPositive;
}

}  // namespace offnominal::desk
