#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <offnominal/model/chain.hpp>
#include <span>

namespace offnominal::desk::exchange {

/// A body in one frame: kg, m, and the inertia about its own centre of mass in the frame's axes, kg
/// m^2.
struct RigidBody {
  double mass_kg = 0;
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();
};

/// The same body seen from the frame in which its own one stands at `place`.
[[nodiscard]] RigidBody seen_from(const RigidBody& body, const Eigen::Isometry3d& place);

/// All of them, stuck together. A negative mass takes away; the sum of the masses is not 0 unless
/// all are.
[[nodiscard]] RigidBody joined(std::span<const RigidBody> bodies);

[[nodiscard]] RigidBody body_of(const Joint<double>& joint);
void put_body(const RigidBody& body, Joint<double>& joint);

/// The joint's frame in the frame before it.
void put_placement(const Eigen::Isometry3d& placement, Joint<double>& joint);

}  // namespace offnominal::desk::exchange
