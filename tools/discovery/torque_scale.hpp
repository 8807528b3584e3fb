#pragma once

#include "discovery/regression.hpp"

namespace offnominal::tools::discovery {

// A robot file's torque scale multiplies all that acts on its joint; in a regression it stands
// beside the other terms. What the coefficients of `effect` on `joint` are multiplied with to be
// those of a file: 1 / (1 + error). 1 where no torque scale is among the terms, and for effects
// that act on the sum of a joint's torques themselves.
double factor_beside_torque_scale(const std::vector<Term>& terms, const ModelFit& fit,
                                  Eigen::Index joint, EffectKind effect);

}  // namespace offnominal::tools::discovery
