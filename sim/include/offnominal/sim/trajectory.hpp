// Desired motion of section 5.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "offnominal/sim/two_link_arm.hpp"

namespace offnominal::sim {

struct DesiredMotion {
  Eigen::Vector2d q;    ///< rad
  Eigen::Vector2d dq;   ///< rad/s
  Eigen::Vector2d ddq;  ///< rad/s^2
};

/// q1d = 0.18 sin 2t, q2d = 0.21 sin 3t and their derivatives. The paper does not print its
/// trajectory; this one agrees with its domain D and with its detection results.
inline DesiredMotion paper_trajectory(double t_s) {
  const double a1 = 0.18, w1 = 2.0, a2 = 0.21, w2 = 3.0;
  const double s1 = std::sin(w1 * t_s), c1 = std::cos(w1 * t_s);
  const double s2 = std::sin(w2 * t_s), c2 = std::cos(w2 * t_s);
  return {
      {a1 * s1, a2 * s2}, {a1 * w1 * c1, a2 * w2 * c2}, {-a1 * w1 * w1 * s1, -a2 * w2 * w2 * s2}};
}

/// State of an arm that starts on its desired motion.
inline JointState on_trajectory(const DesiredMotion& motion) { return {motion.q, motion.dq}; }

}  // namespace offnominal::sim
