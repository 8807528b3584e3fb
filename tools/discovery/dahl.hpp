#pragma once

#include <Eigen/Core>
#include <offnominal/model/effects/memory.hpp>

namespace offnominal::tools::discovery {

// Normalised friction state of P. R. Dahl along a path, 0 at its beginning: core's hysteresis of
// level 1.
inline Eigen::VectorXd dahl_state(const Eigen::Ref<const Eigen::VectorXd>& q, double width) {
  const std::array<double, kMaxEffectParameters> parameters{1, width};
  Eigen::VectorXd z(q.size());
  double state = 0;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (i > 0) state = effects::Hysteresis::next_state(parameters, state, q[i] - q[i - 1]);
    z[i] = state;
  }
  return z;
}

}  // namespace offnominal::tools::discovery
