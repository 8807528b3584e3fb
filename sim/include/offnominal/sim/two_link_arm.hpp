// Planar arm with two revolute joints and a point mass at the end of each link, in closed form.
// Source: Lewis, Dawson, Abdallah, Control of Robot Manipulators, section 3.2; parameters from
// Table I of Vemuri and Polycarpou.
#pragma once

#include <Eigen/Core>

namespace offnominal::sim {

/// Geometry and masses. Lengths and masses are positive.
struct TwoLinkParameters {
  double mass1_kg = 0.5;  ///< at the end of link 1
  double mass2_kg = 2.0;  ///< at the end of link 2
  double length1_m = 1.0;
  double length2_m = 1.0;
  double gravity_m_s2 = 9.81;  ///< acts along -y; 0 for a horizontal arm
};

/// Positions and velocities of both joints. q[0] is the angle of link 1 from the horizontal,
/// q[1] the angle of link 2 from link 1, both counter-clockwise.
struct TwoLinkState {
  Eigen::Vector2d q = Eigen::Vector2d::Zero();   ///< rad
  Eigen::Vector2d dq = Eigen::Vector2d::Zero();  ///< rad/s
};

/// M(q), symmetric and positive definite, kg m^2.
Eigen::Matrix2d mass_matrix(const TwoLinkParameters& arm, const Eigen::Vector2d& q);

/// V(q, dq) dq, the centripetal and Coriolis torque, N m.
Eigen::Vector2d velocity_torque(const TwoLinkParameters& arm, const TwoLinkState& state);

/// G(q), the torque that holds the arm against gravity, N m.
Eigen::Vector2d gravity_torque(const TwoLinkParameters& arm, const Eigen::Vector2d& q);

/// M^-1 (tau - V dq - G), rad/s^2, for the net joint torque tau in N m. Not finite where M is
/// singular, which positive masses and lengths exclude.
Eigen::Vector2d forward_acceleration(const TwoLinkParameters& arm, const TwoLinkState& state,
                                     const Eigen::Vector2d& tau);

/// 1/2 dq' M dq, J.
double kinetic_energy(const TwoLinkParameters& arm, const TwoLinkState& state);

/// Energy of both masses in the field of gravity, zero at the height of joint 1, J.
double potential_energy(const TwoLinkParameters& arm, const Eigen::Vector2d& q);

}  // namespace offnominal::sim
