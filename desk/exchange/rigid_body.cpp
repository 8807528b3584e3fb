#include "exchange/rigid_body.hpp"

namespace offnominal::desk::exchange {

RigidBody seen_from(const RigidBody& body, const Eigen::Isometry3d& place) {
  const Eigen::Matrix3d rotation = place.linear();
  return {body.mass_kg, place * body.centre_m,
          rotation * body.inertia_kg_m2 * rotation.transpose()};
}

RigidBody joined(std::span<const RigidBody> bodies) {
  RigidBody sum;
  for (const RigidBody& body : bodies) {
    sum.mass_kg += body.mass_kg;
    sum.centre_m += body.mass_kg * body.centre_m;
  }
  if (sum.mass_kg == 0) return {};
  sum.centre_m /= sum.mass_kg;
  // A body alone stays what it is, to the bit.
  if (bodies.size() == 1) return bodies.front();
  for (const RigidBody& body : bodies) {
    const Eigen::Vector3d r = body.centre_m - sum.centre_m;
    sum.inertia_kg_m2 +=
        body.inertia_kg_m2 +
        body.mass_kg * (r.squaredNorm() * Eigen::Matrix3d::Identity() - r * r.transpose());
  }
  return sum;
}

RigidBody body_of(const Joint<double>& joint) {
  const auto& [xx, yy, zz, xy, xz, yz] = joint.inertia_kg_m2;
  RigidBody body{joint.mass_kg, Eigen::Vector3d(joint.centre_of_mass_m.data()), {}};
  body.inertia_kg_m2 << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return body;
}

void put_body(const RigidBody& body, Joint<double>& joint) {
  const Eigen::Matrix3d& tensor = body.inertia_kg_m2;
  // A sum of 0 and -0 is 0.
  joint.mass_kg = body.mass_kg;
  joint.centre_of_mass_m = {body.centre_m.x() + 0.0, body.centre_m.y() + 0.0,
                            body.centre_m.z() + 0.0};
  joint.inertia_kg_m2 = {tensor(0, 0) + 0.0, tensor(1, 1) + 0.0, tensor(2, 2) + 0.0,
                         tensor(0, 1) + 0.0, tensor(0, 2) + 0.0, tensor(1, 2) + 0.0};
}

void put_placement(const Eigen::Isometry3d& placement, Joint<double>& joint) {
  for (int i = 0; i < 3; ++i) {
    joint.origin_m[static_cast<std::size_t>(i)] = placement.translation()[i] + 0.0;
    for (int j = 0; j < 3; ++j) {
      joint.rotation[static_cast<std::size_t>(3 * i + j)] = placement.linear()(i, j) + 0.0;
    }
  }
}

}  // namespace offnominal::desk::exchange
