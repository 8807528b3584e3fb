#pragma once

#include <Eigen/Core>
#include <cmath>

namespace offnominal::test {

// Planar arm with a point mass at the end of each link, q1 from the horizontal, q2 from link 1:
// F. L. Lewis, C. T. Abdallah, D. M. Dawson, Control of Robot Manipulators, 1993, example 3.2-2.
struct TwoLinkClosedForm {
  double mass1 = 0.5;
  double mass2 = 0.7;
  double length1 = 1.1;
  double length2 = 0.8;
  double gravity = 9.81;

  Eigen::Matrix2d inertia(const Eigen::Vector2d& q) const {
    const double cosine = std::cos(q[1]);
    const double coupling = mass2 * length1 * length2 * cosine;
    const double outer = mass2 * length2 * length2;
    Eigen::Matrix2d m;
    m(0, 0) = (mass1 + mass2) * length1 * length1 + outer + 2 * coupling;
    m(0, 1) = outer + coupling;
    m(1, 0) = m(0, 1);
    m(1, 1) = outer;
    return m;
  }

  Eigen::Vector2d coriolis(const Eigen::Vector2d& q, const Eigen::Vector2d& dq) const {
    const double h = mass2 * length1 * length2 * std::sin(q[1]);
    return {-h * (2 * dq[0] * dq[1] + dq[1] * dq[1]), h * dq[0] * dq[0]};
  }

  Eigen::Vector2d weight(const Eigen::Vector2d& q) const {
    const double second = mass2 * gravity * length2 * std::cos(q[0] + q[1]);
    return {(mass1 + mass2) * gravity * length1 * std::cos(q[0]) + second, second};
  }

  Eigen::Vector2d bias(const Eigen::Vector2d& q, const Eigen::Vector2d& dq) const {
    return coriolis(q, dq) + weight(q);
  }

  Eigen::Vector2d torque(const Eigen::Vector2d& q, const Eigen::Vector2d& dq,
                         const Eigen::Vector2d& ddq) const {
    return inertia(q) * ddq + bias(q, dq);
  }

  // Cramer's rule.
  Eigen::Vector2d acceleration(const Eigen::Vector2d& q, const Eigen::Vector2d& dq,
                               const Eigen::Vector2d& tau) const {
    const Eigen::Matrix2d m = inertia(q);
    const Eigen::Vector2d rest = tau - bias(q, dq);
    const double determinant = m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0);
    return {(m(1, 1) * rest[0] - m(0, 1) * rest[1]) / determinant,
            (m(0, 0) * rest[1] - m(1, 0) * rest[0]) / determinant};
  }
};

}  // namespace offnominal::test
