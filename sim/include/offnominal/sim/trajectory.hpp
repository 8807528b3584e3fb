// Desired motion of section 5.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "offnominal/sim/joint_state.hpp"

namespace offnominal::sim {

/// q1d = 0.18 sin 2t, q2d = 0.21 sin 3t and their derivatives. The paper does not print its
/// trajectory; this one agrees with its domain D and with its detection results.
inline DesiredMotion paper_trajectory(double t_s) {
  const double a1 = 0.18, w1 = 2.0, a2 = 0.21, w2 = 3.0;
  const double s1 = std::sin(w1 * t_s), c1 = std::cos(w1 * t_s);
  const double s2 = std::sin(w2 * t_s), c2 = std::cos(w2 * t_s);
  return {Eigen::Vector2d(a1 * s1, a2 * s2), Eigen::Vector2d(a1 * w1 * c1, a2 * w2 * c2),
          Eigen::Vector2d(-a1 * w1 * w1 * s1, -a2 * w2 * w2 * s2)};
}

}  // namespace offnominal::sim
