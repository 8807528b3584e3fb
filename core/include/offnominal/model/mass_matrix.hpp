#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <offnominal/model/joint_transforms.hpp>
#include <offnominal/model/rigid_body_model.hpp>

namespace offnominal {

namespace detail {

// The same body about the origin of the parent's frame, in its axes.
template <typename Scalar>
[[nodiscard]] inline SpatialInertia<Scalar> moved_to_parent(const SpatialInertia<Scalar>& body,
                                                            const Matrix<3, 3, Scalar>& rotation,
                                                            const Vector<3, Scalar>& origin) {
  SpatialInertia<Scalar> moved;
  const Vector<3, Scalar> h = rotated<Scalar>(rotation, body.first_moment);
  const Matrix<3, 3, Scalar> half = rotation.lazyProduct(body.inertia);
  moved.mass = body.mass;
  moved.first_moment = h + body.mass * origin;
  // -([p][h] + [h][p] + m [p][p]) written out: [a][b] = b a^T - (a.b) I.
  const Scalar diagonal = Scalar(2) * origin.dot(h) + body.mass * origin.squaredNorm();
  const Vector<3, Scalar> outer = h + body.mass * origin;
  moved.inertia = half.lazyProduct(rotation.transpose());
  moved.inertia -= outer.lazyProduct(origin.transpose()) + origin.lazyProduct(h.transpose());
  moved.inertia.diagonal().array() += diagonal;
  return moved;
}

// 2 T of a body whose link's frame is moved by a unit speed of the joint before it, that joint
// lying at the parent's origin along `axis` (parent's frame).
template <typename Scalar>
[[nodiscard]] inline Scalar inertia_seen_by_parent(const SpatialInertia<Scalar>& body,
                                                   const Matrix<3, 3, Scalar>& rotation,
                                                   const Vector<3, Scalar>& origin, JointType type,
                                                   const Vector<3, Scalar>& axis) {
  if (type == JointType::kPrismatic) return body.mass;
  using Vec3 = Vector<3, Scalar>;
  const Vec3 omega = rotated_back<Scalar>(rotation, axis);
  const Vec3 velocity = rotated_back<Scalar>(rotation, axis.cross(origin));
  const Vec3 momentum = body.mass * velocity + Scalar(2) * omega.cross(body.first_moment);
  const Vec3 spin = times<Scalar>(body.inertia, omega);
  return velocity.dot(momentum) + omega.dot(spin);
}

}  // namespace detail

// Joint-space inertia M(q) by the composite-rigid-body algorithm (Featherstone 2008, ch. 6):
// kg m^2, kg m or kg. Symmetric, and positive definite for a chain that validate() accepts unless a
// joint moves nothing: a point mass on its own axis, or a mass that effects have taken away.
template <int N, typename Scalar>
[[nodiscard]] Matrix<N, N, Scalar> mass_matrix(const RigidBodyModel<N, Scalar>& model,
                                               const JointTransforms<N, Scalar>& at) {
  using Vec3 = Vector<3, Scalar>;
  const std::size_t count = model.bodies.size();
  Matrix<N, N, Scalar> m;
  m.resize(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  SpatialInertia<Scalar> composite = model.bodies[count - 1].link;
  for (std::size_t j = count; j-- > 1;) {
    const auto& body = model.bodies[j];
    const auto column = static_cast<Eigen::Index>(j);
    Vec3 force;
    Vec3 moment;
    if (body.type == JointType::kRevolute) {
      force = body.axis.cross(composite.first_moment);
      moment = detail::times<Scalar>(composite.inertia, body.axis);
    } else {
      force = composite.mass * body.axis;
      moment = composite.first_moment.cross(body.axis);
    }
    const Vec3& own = body.type == JointType::kRevolute ? moment : force;
    m(column, column) = body.axis.dot(own) + body.reflected_inertia;
    for (std::size_t i = j; i > 0; --i) {
      const Vec3 passed = detail::rotated<Scalar>(at.rotation[i], force);
      moment = detail::rotated<Scalar>(at.rotation[i], moment) + at.origin[i].cross(passed);
      force = passed;
      const auto& parent = model.bodies[i - 1];
      const auto row = static_cast<Eigen::Index>(i - 1);
      const Vec3& along = parent.type == JointType::kRevolute ? moment : force;
      m(row, column) = parent.axis.dot(along);
      m(column, row) = m(row, column);
    }
    if (j > 1) {
      composite = detail::moved_to_parent(composite, at.rotation[j], at.origin[j]);
      composite += model.bodies[j - 1].link;
    }
  }
  // The first joint asks for one number of what it carries, not for the whole body.
  const auto& first = model.bodies[0];
  m(0, 0) = first.reflected_inertia +
            (first.type == JointType::kRevolute
                 ? first.axis.dot(detail::times<Scalar>(first.link.inertia, first.axis))
                 : first.link.mass);
  if constexpr (N != 1) {
    if (count > 1) {
      m(0, 0) += detail::inertia_seen_by_parent(composite, at.rotation[1], at.origin[1], first.type,
                                                first.axis);
    }
  }
  if (model.has_rotors) m += model.rotors;
  return m;
}

template <int N, typename Scalar>
[[nodiscard]] Matrix<N, N, Scalar> mass_matrix(const RigidBodyModel<N, Scalar>& model,
                                               const Vector<N, Scalar>& q) {
  return mass_matrix(model, joint_transforms(model, q));
}

}  // namespace offnominal
