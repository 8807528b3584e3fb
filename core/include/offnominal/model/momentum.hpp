#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/joint_transforms.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/model/torque_path.hpp>

// The generalised momentum p = M(q) dq and what the model says of its rate,
//   p' = load + dT/dq - G(q),   2 T = dq^T M(q) dq,
// with the load that load_torque() leaves of what the drives give. It is the equation of motion
// once more, since M' dq - V dq = dT/dq (A. De Luca, R. Mattone, ICRA 2005), without M itself: one
// way out along the chain for the links' velocities, one way back for the momentum of all that a
// joint carries (in the manner of A. De Luca, L. Ferrajoli, ICRA 2009). With omega and v of link
// i's frame, in that frame, and the angular and linear momentum L and P of link i and all behind it
// about the frame's origin, a revolute joint's
//   p_i = a . L,   dT/dq_i = a . (L x omega + P x v),
// and a prismatic one's p_i = a . P, dT/dq_i = a . (P x omega): a joint that moves turns (shifts)
// the velocity that all links behind it get from the links before it.

namespace offnominal {

template <int N, typename Scalar>
struct MomentumForm {
  Vector<N, Scalar> momentum = zeros<N, Scalar>();  // p, N m s or N s
  // dT/dq - G(q), N m or N: what acts on p beside the load.
  Vector<N, Scalar> pull = zeros<N, Scalar>();
};

namespace detail {

// In the link's own frame, gravity too.
template <int N, typename Scalar>
struct LinkMotion {
  static constexpr auto kMost = static_cast<std::size_t>(kMostJoints<N>);
  std::array<Vector<3, Scalar>, kMost> omega;
  std::array<Vector<3, Scalar>, kMost> v;
  std::array<Vector<3, Scalar>, kMost> gravity;
};

template <int N, typename Scalar>
EIGEN_ALWAYS_INLINE void move_links(const RigidBodyModel<N, Scalar>& model,
                                    const JointTransforms<N, Scalar>& at,
                                    const Vector<N, Scalar>& dq, LinkMotion<N, Scalar>& links) {
  using Vec3 = Vector<3, Scalar>;
  Vec3 omega = Vec3::Zero();
  Vec3 v = Vec3::Zero();
  Vec3 gravity = model.gravity;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const auto& body = model.bodies[i];
    gravity = rotated_back<Scalar>(at.rotation[i], gravity);
    if (i > 0) {
      v = rotated_back<Scalar>(at.rotation[i], v + omega.cross(at.origin[i]));
      omega = rotated_back<Scalar>(at.rotation[i], omega);
    }
    const Vec3 relative = body.axis * dq[static_cast<Eigen::Index>(i)];
    (body.type == JointType::kRevolute ? omega : v) += relative;
    links.omega[i] = omega;
    links.v[i] = v;
    links.gravity[i] = gravity;
  }
}

}  // namespace detail

// Of a chain at (q, dq), reflected inertias and payloads included. Non-finite input gives
// non-finite output.
template <int N, typename Scalar>
[[nodiscard]] MomentumForm<N, Scalar> momentum_form(const RigidBodyModel<N, Scalar>& model,
                                                    const JointTransforms<N, Scalar>& at,
                                                    const Vector<N, Scalar>& dq) {
  using Vec3 = Vector<3, Scalar>;
  using detail::rotated;
  const std::size_t count = model.bodies.size();
  detail::LinkMotion<N, Scalar> links;
  detail::move_links(model, at, dq, links);
  MomentumForm<N, Scalar> form;
  size_for(count, form.momentum, form.pull);
  Vec3 angular = Vec3::Zero();  // L, P, and the mass and its first moment of all that is carried
  Vec3 linear = Vec3::Zero();
  Vec3 first_moment = Vec3::Zero();
  Scalar mass{};
  for (std::size_t i = count; i-- > 0;) {
    const auto& body = model.bodies[i];
    const auto index = static_cast<Eigen::Index>(i);
    const Vec3& h = body.link.first_moment;
    mass += body.link.mass;
    first_moment += h;
    linear += body.link.mass * links.v[i] + links.omega[i].cross(h);
    angular += detail::times<Scalar>(body.link.inertia, links.omega[i]) + h.cross(links.v[i]);
    if (body.type == JointType::kRevolute) {
      form.momentum[index] = body.axis.dot(angular);
      form.pull[index] = body.axis.dot(angular.cross(links.omega[i]) + linear.cross(links.v[i]) +
                                       first_moment.cross(links.gravity[i]));
    } else {
      form.momentum[index] = body.axis.dot(linear);
      form.pull[index] = body.axis.dot(linear.cross(links.omega[i]) + mass * links.gravity[i]);
    }
    form.momentum[index] += body.reflected_inertia * dq[index];
    if (i > 0) {
      linear = rotated<Scalar>(at.rotation[i], linear);
      angular = rotated<Scalar>(at.rotation[i], angular) + at.origin[i].cross(linear);
      first_moment = rotated<Scalar>(at.rotation[i], first_moment) + mass * at.origin[i];
    }
  }
  if (model.has_rotors) form.momentum += model.rotors.lazyProduct(dq);
  return form;
}

// What the model says of the momentum at one instant.
template <int N, typename Scalar>
struct MomentumDynamics {
  Vector<N, Scalar> momentum = zeros<N, Scalar>();  // p, N m s or N s
  Vector<N, Scalar> rate = zeros<N, Scalar>();      // p', N m or N
  // As of ForwardDynamics.
  Vector<N, Scalar> told_per_load = ones<N, Scalar>();
};

// Of a drive that gives tau, N m or N, at time_s since the run's origin. `at`: of q.
template <int N, typename Scalar>
[[nodiscard]] MomentumDynamics<N, Scalar> momentum_dynamics(const RigidBodyModel<N, Scalar>& model,
                                                            const JointTransforms<N, Scalar>& at,
                                                            const Vector<N, Scalar>& q,
                                                            const Vector<N, Scalar>& dq,
                                                            const Vector<N, Scalar>& tau,
                                                            double time_s) {
  const MomentumForm<N, Scalar> form = momentum_form(model, at, dq);
  const JointEffects<N, Scalar> effects = joint_effects(model, q, dq, time_s);
  const Vector<N, Scalar> load = load_torque(model, effects, tau);
  return {form.momentum, load + form.pull, told_per_load(model, effects, load)};
}
template <int N, typename Scalar>
[[nodiscard]] MomentumDynamics<N, Scalar> momentum_dynamics(const RigidBodyModel<N, Scalar>& model,
                                                            const Vector<N, Scalar>& q,
                                                            const Vector<N, Scalar>& dq,
                                                            const Vector<N, Scalar>& tau,
                                                            double time_s) {
  return momentum_dynamics(model, joint_transforms(model, q), q, dq, tau, time_s);
}

}  // namespace offnominal
