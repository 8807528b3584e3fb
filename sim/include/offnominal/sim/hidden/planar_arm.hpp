// Planar arm of two rigid links with distributed mass, in closed form, from the Lagrangian with the
// absolute angles of the links: a1 = q1, a12 = q1 + q2.
#pragma once

#include <Eigen/Core>
#include <array>

namespace offnominal::sim::hidden {

struct RigidLink {
  double mass_kg = 1.0;
  double length_m = 0.4;
  double centre_of_mass_m = 0.2;
  double inertia_kg_m2 = 0.01;  ///< about the centre of mass
};

/// The links' numbers, collected into the few that the equations of motion need.
class PlanarArm {
 public:
  PlanarArm() = default;
  /// Gravity acts along -y.
  PlanarArm(const std::array<RigidLink, 2>& links, double gravity_m_s2, double tip_mass_kg = 0.0);

  struct Terms {
    Eigen::Matrix2d mass;  ///< kg m^2
    Eigen::Vector2d bias;  ///< centripetal, Coriolis and gravity torque, N m
  };
  [[nodiscard]] Terms terms(const Eigen::Vector2d& q, const Eigen::Vector2d& dq) const;

  /// Joint torques for a motion, N m.
  [[nodiscard]] Eigen::Vector2d torque(const Eigen::Vector2d& q, const Eigen::Vector2d& dq,
                                       const Eigen::Vector2d& ddq) const;

  /// Kinetic and potential energy, J; the latter is 0 with both links along x.
  [[nodiscard]] double energy(const Eigen::Vector2d& q, const Eigen::Vector2d& dq) const;

 private:
  double inertia1_ = 0.0;  // of link 1 and what it carries at its end, about joint 1
  double inertia2_ = 0.0;  // of link 2 about joint 2
  double coupling_ = 0.0;  // first moment of link 2 about joint 2, times the length of link 1
  double weight1_ = 0.0;   // torques of both links' weights, held out horizontally
  double weight2_ = 0.0;
};

}  // namespace offnominal::sim::hidden
