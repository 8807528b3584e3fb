#include "offnominal/sim/hidden/planar_arm.hpp"

#include <cmath>

namespace offnominal::sim::hidden {

using Eigen::Vector2d;

PlanarArm::PlanarArm(const std::array<RigidLink, 2>& links, double gravity_m_s2,
                     double tip_mass_kg) {
  const RigidLink& a = links[0];
  const RigidLink& b = links[1];
  const double carried = b.mass_kg + tip_mass_kg;
  const double moment2 = b.mass_kg * b.centre_of_mass_m + tip_mass_kg * b.length_m;
  inertia1_ = a.inertia_kg_m2 + a.mass_kg * a.centre_of_mass_m * a.centre_of_mass_m +
              carried * a.length_m * a.length_m;
  inertia2_ = b.inertia_kg_m2 + b.mass_kg * b.centre_of_mass_m * b.centre_of_mass_m +
              tip_mass_kg * b.length_m * b.length_m;
  coupling_ = moment2 * a.length_m;
  weight1_ = (a.mass_kg * a.centre_of_mass_m + carried * a.length_m) * gravity_m_s2;
  weight2_ = moment2 * gravity_m_s2;
}

PlanarArm::Terms PlanarArm::terms(const Vector2d& q, const Vector2d& dq) const {
  const double c = coupling_ * std::cos(q[1]), s = coupling_ * std::sin(q[1]);
  const double w1 = dq[0], w12 = dq[0] + dq[1];
  // In absolute angles the only velocity torques are the centripetal ones of w12^2 and w1^2.
  const double link1 = -s * w12 * w12 + weight1_ * std::cos(q[0]);
  const double link2 = s * w1 * w1 + weight2_ * std::cos(q[0] + q[1]);
  Terms terms;
  terms.mass(0, 0) = inertia1_ + inertia2_ + 2.0 * c;
  terms.mass(0, 1) = terms.mass(1, 0) = inertia2_ + c;
  terms.mass(1, 1) = inertia2_;
  terms.bias = {link1 + link2, link2};
  return terms;
}

Vector2d PlanarArm::torque(const Vector2d& q, const Vector2d& dq, const Vector2d& ddq) const {
  const Terms t = terms(q, dq);
  return t.mass * ddq + t.bias;
}

double PlanarArm::energy(const Vector2d& q, const Vector2d& dq) const {
  const double w1 = dq[0], w12 = dq[0] + dq[1];
  return 0.5 * inertia1_ * w1 * w1 + 0.5 * inertia2_ * w12 * w12 +
         coupling_ * std::cos(q[1]) * w1 * w12 + weight1_ * std::sin(q[0]) +
         weight2_ * std::sin(q[0] + q[1]);
}

}  // namespace offnominal::sim::hidden
