#include "offnominal/sim/two_link_arm.hpp"

#include <cmath>

namespace offnominal::sim {

Eigen::Matrix2d mass_matrix(const TwoLinkParameters& arm, const Eigen::Vector2d& q) {
  const double a1 = arm.length1_m, a2 = arm.length2_m, m2 = arm.mass2_kg;
  const double coupling = m2 * a1 * a2 * std::cos(q[1]);
  const double m22 = m2 * a2 * a2;
  const double m12 = m22 + coupling;
  const double m11 = (arm.mass1_kg + m2) * a1 * a1 + m22 + 2.0 * coupling;
  Eigen::Matrix2d m;
  m << m11, m12, m12, m22;
  return m;
}

Eigen::Vector2d velocity_torque(const TwoLinkParameters& arm, const TwoLinkState& state) {
  const double h = arm.mass2_kg * arm.length1_m * arm.length2_m * std::sin(state.q[1]);
  const double dq1 = state.dq[0], dq2 = state.dq[1];
  return {-h * (2.0 * dq1 * dq2 + dq2 * dq2), h * dq1 * dq1};
}

Eigen::Vector2d gravity_torque(const TwoLinkParameters& arm, const Eigen::Vector2d& q) {
  const double g = arm.gravity_m_s2;
  const double g2 = arm.mass2_kg * g * arm.length2_m * std::cos(q[0] + q[1]);
  return {(arm.mass1_kg + arm.mass2_kg) * g * arm.length1_m * std::cos(q[0]) + g2, g2};
}

Eigen::Vector2d forward_acceleration(const TwoLinkParameters& arm, const TwoLinkState& state,
                                     const Eigen::Vector2d& tau) {
  const Eigen::Matrix2d m = mass_matrix(arm, state.q);
  const Eigen::Vector2d b = tau - velocity_torque(arm, state) - gravity_torque(arm, state.q);
  const double det = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
  return {(m(1, 1) * b[0] - m(0, 1) * b[1]) / det, (m(0, 0) * b[1] - m(1, 0) * b[0]) / det};
}

double kinetic_energy(const TwoLinkParameters& arm, const TwoLinkState& state) {
  return 0.5 * state.dq.dot(mass_matrix(arm, state.q) * state.dq);
}

double potential_energy(const TwoLinkParameters& arm, const Eigen::Vector2d& q) {
  const double y1 = arm.length1_m * std::sin(q[0]);
  const double y2 = y1 + arm.length2_m * std::sin(q[0] + q[1]);
  return arm.gravity_m_s2 * (arm.mass1_kg * y1 + arm.mass2_kg * y2);
}

}  // namespace offnominal::sim
