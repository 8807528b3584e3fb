#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <offnominal/model/joint_transforms.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/model/torque_path.hpp>

// Recursive Newton-Euler in the links' own frames (J. Y. S. Luh, M. W. Walker, R. P. Paul, ASME
// JDSMC 102, 1980; in this form R. Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 5).
// Gravity enters as an acceleration of the base. Non-finite input gives non-finite output.

namespace offnominal {

namespace detail {

// omega x (omega x r)
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<3, Scalar> centripetal(const Vector<3, Scalar>& omega,
                                                                Scalar omega_squared,
                                                                const Vector<3, Scalar>& r) {
  return omega.dot(r) * omega - omega_squared * r;
}

// With Accelerating = false ddq counts as zero and is not read.
template <bool Accelerating, int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> rigid_body_torque(const RigidBodyModel<N, Scalar>& model,
                                                  const JointTransforms<N, Scalar>& at,
                                                  const Vector<N, Scalar>& dq,
                                                  const Vector<N, Scalar>& ddq) {
  using Vec3 = Vector<3, Scalar>;
  constexpr auto kMost = static_cast<std::size_t>(kMostJoints<N>);
  const std::size_t count = model.bodies.size();
  std::array<Vec3, kMost> force;   // on link i from the link before it, link's frame
  std::array<Vec3, kMost> moment;  // about the origin of the link's frame

  Vec3 omega = Vec3::Zero();
  Vec3 omega_dot = Vec3::Zero();
  Vec3 acceleration = rotated_back<Scalar>(at.rotation[0], -model.gravity);
  // The first joint's frame does not turn, so that the link can only turn about the joint's axis:
  // its own spin has no moment about that axis, and the force on it is nobody's concern.
  const auto& first = model.bodies[0];
  if (first.type == JointType::kRevolute) {
    omega = first.axis * dq[0];
    moment[0] = first.link.first_moment.cross(acceleration);
    if constexpr (Accelerating) {
      omega_dot = first.axis * ddq[0];
      moment[0] += times<Scalar>(first.link.inertia, omega_dot);
    }
    force[0].setZero();
  } else {
    if constexpr (Accelerating) acceleration += first.axis * ddq[0];
    force[0] = first.link.mass * acceleration;
    moment[0].setZero();
  }
  for (std::size_t i = 1; i < count; ++i) {
    const auto& body = model.bodies[i];
    const auto index = static_cast<Eigen::Index>(i);
    acceleration += centripetal<Scalar>(omega, omega.squaredNorm(), at.origin[i]);
    omega = rotated_back<Scalar>(at.rotation[i], omega);
    if (Accelerating || i > 1) {
      acceleration += omega_dot.cross(at.origin[i]);
      omega_dot = rotated_back<Scalar>(at.rotation[i], omega_dot);
    }
    acceleration = rotated_back<Scalar>(at.rotation[i], acceleration);
    const Vec3 relative = body.axis * dq[index];
    const Vec3 coriolis = omega.cross(relative);
    if (body.type == JointType::kRevolute) {
      omega_dot += coriolis;
      omega += relative;
      if constexpr (Accelerating) omega_dot += body.axis * ddq[index];
    } else {
      acceleration += Scalar(2) * coriolis;
      if constexpr (Accelerating) acceleration += body.axis * ddq[index];
    }
    const Vec3& h = body.link.first_moment;
    const Vec3 spin = times<Scalar>(body.link.inertia, omega);
    force[i] = body.link.mass * acceleration + omega_dot.cross(h) +
               centripetal<Scalar>(omega, omega.squaredNorm(), h);
    moment[i] =
        times<Scalar>(body.link.inertia, omega_dot) + omega.cross(spin) + h.cross(acceleration);
  }

  Vector<N, Scalar> torque;
  torque.resize(static_cast<Eigen::Index>(count));
  for (std::size_t i = count; i-- > 0;) {
    const auto& body = model.bodies[i];
    const auto index = static_cast<Eigen::Index>(i);
    const Vec3& along = body.type == JointType::kRevolute ? moment[i] : force[i];
    torque[index] = body.axis.dot(along);
    if constexpr (Accelerating) torque[index] += body.reflected_inertia * ddq[index];
    if (i > 0) {
      const Vec3 passed = rotated<Scalar>(at.rotation[i], force[i]);
      force[i - 1] += passed;
      moment[i - 1] += rotated<Scalar>(at.rotation[i], moment[i]) + at.origin[i].cross(passed);
    }
  }
  if constexpr (Accelerating) {
    if (model.has_rotors) torque += model.rotors.lazyProduct(ddq);
  }
  return torque;
}

}  // namespace detail

// M(q) ddq + V(q, dq) dq + G(q), N m or N per joint, reflected inertias and payloads included,
// torque effects not.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> rigid_body_torque(const RigidBodyModel<N, Scalar>& model,
                                                  const JointTransforms<N, Scalar>& at,
                                                  const Vector<N, Scalar>& dq,
                                                  const Vector<N, Scalar>& ddq) {
  return detail::rigid_body_torque<true, N, Scalar>(model, at, dq, ddq);
}

// V(q, dq) dq + G(q) alone: the same without acceleration.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> rigid_body_bias(const RigidBodyModel<N, Scalar>& model,
                                                const JointTransforms<N, Scalar>& at,
                                                const Vector<N, Scalar>& dq) {
  return detail::rigid_body_torque<false, N, Scalar>(model, at, dq, dq);
}

// The torque that the drive has to be told for the motion (q, dq, ddq) at time_s, effects included.
// `at`: of q.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> inverse_dynamics(const RigidBodyModel<N, Scalar>& model,
                                                 const JointTransforms<N, Scalar>& at,
                                                 const Vector<N, Scalar>& q,
                                                 const Vector<N, Scalar>& dq,
                                                 const Vector<N, Scalar>& ddq, double time_s) {
  return drive_torque<N, Scalar>(model, joint_effects(model, q, dq, time_s),
                                 rigid_body_torque(model, at, dq, ddq));
}
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> inverse_dynamics(const RigidBodyModel<N, Scalar>& model,
                                                 const Vector<N, Scalar>& q,
                                                 const Vector<N, Scalar>& dq,
                                                 const Vector<N, Scalar>& ddq, double time_s) {
  return inverse_dynamics(model, joint_transforms(model, q), q, dq, ddq, time_s);
}

// The same without acceleration: V(q, dq) dq + G(q) and the effects.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> bias_torque(const RigidBodyModel<N, Scalar>& model,
                                            const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                            double time_s) {
  return drive_torque<N, Scalar>(model, joint_effects(model, q, dq, time_s),
                                 rigid_body_bias(model, joint_transforms(model, q), dq));
}

}  // namespace offnominal
