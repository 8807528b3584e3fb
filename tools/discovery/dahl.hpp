#pragma once

#include <Eigen/Core>
#include <cmath>

namespace offnominal::tools::discovery {

// Normalised friction state of P. R. Dahl (AIAA Journal 14(12), 1976) with exponent 1 along a path:
// dz/dq = (1 - z sgn(dq)) / width, z = 0 at the beginning.
inline Eigen::VectorXd dahl_state(const Eigen::Ref<const Eigen::VectorXd>& q, double width) {
  Eigen::VectorXd z(q.size());
  double state = 0;
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    if (i > 0) {
      const double step = q[i] - q[i - 1];
      const double target = step >= 0 ? 1.0 : -1.0;
      state = target + (state - target) * std::exp(-std::abs(step) / width);
    }
    z[i] = state;
  }
  return z;
}

}  // namespace offnominal::tools::discovery
