#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <offnominal/model/joint_transforms.hpp>
#include <offnominal/model/momentum.hpp>
#include <offnominal/model/rigid_body_model.hpp>

namespace offnominal {

// Mass and first moments (x, y, z) of a body on the last link, in that link's frame.
inline constexpr int kTipParameters = 4;

// What a body on the last link adds to the chain's momentum form, per parameter: p and pull of
// MomentumForm are these times [kg, kg m, kg m, kg m]. Its second moments are left out.
template <int N, typename Scalar>
struct TipBodyForm {
  using Values = Matrix<kTipParameters, N, Scalar>;  // columns: joints
  Values momentum = no_values<Values>();             // N m s per kg or per kg m; prismatic N s
  Values pull = no_values<Values>();                 // N m per kg or per kg m; prismatic N
};

namespace detail {

// Axis, frame's origin and velocity of the frame of every link, in the base frame.
template <int N, typename Scalar>
struct BaseMotion {
  static constexpr auto kMost = static_cast<std::size_t>(kMostJoints<N>);
  std::array<Vector<3, Scalar>, kMost> axis;
  std::array<Vector<3, Scalar>, kMost> origin;
  std::array<Vector<3, Scalar>, kMost> omega;
  std::array<Vector<3, Scalar>, kMost> v;
  Matrix<3, 3, Scalar> tip;  // the last link's frame to the base
};

template <int N, typename Scalar>
void move_in_base(const RigidBodyModel<N, Scalar>& model, const JointTransforms<N, Scalar>& at,
                  const Vector<N, Scalar>& dq, BaseMotion<N, Scalar>& links) {
  using Vec3 = Vector<3, Scalar>;
  Matrix<3, 3, Scalar> rotation = Matrix<3, 3, Scalar>::Identity();
  Vec3 origin = Vec3::Zero();
  Vec3 omega = Vec3::Zero();
  Vec3 v = Vec3::Zero();
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const auto& body = model.bodies[i];
    const Vec3 arm = rotated<Scalar>(rotation, at.origin[i]);
    origin += arm;
    v += omega.cross(arm);
    const Matrix<3, 3, Scalar> turned = rotation.lazyProduct(at.rotation[i]);
    rotation = turned;
    links.axis[i] = rotated<Scalar>(rotation, body.axis);
    (body.type == JointType::kRevolute ? omega : v) +=
        links.axis[i] * dq[static_cast<Eigen::Index>(i)];
    links.origin[i] = origin;
    links.omega[i] = omega;
    links.v[i] = v;
  }
  links.tip = rotation;
}

}  // namespace detail

// At (q, dq). All that carries momentum sits behind the last joint, so that each joint sees the
// same L and P, about its own origin: no way back along the chain. In the axes of the base, with
// the velocities v_n, omega_n of the last link and a first moment h on it, P = omega_n x h and L =
// h x v_n + r x P about a joint's origin, r before the link's. What momentum_form() has of them is
// linear in h, so that each joint forms one vector that h is multiplied with. Non-finite input
// gives non-finite output.
template <int N, typename Scalar>
[[nodiscard]] TipBodyForm<N, Scalar> tip_body_form(const RigidBodyModel<N, Scalar>& model,
                                                   const JointTransforms<N, Scalar>& at,
                                                   const Vector<N, Scalar>& dq) {
  using Vec3 = Vector<3, Scalar>;
  using Values = typename TipBodyForm<N, Scalar>::Values;
  const std::size_t count = model.bodies.size();
  detail::BaseMotion<N, Scalar> links;
  detail::move_in_base(model, at, dq, links);
  TipBodyForm<N, Scalar> form{Values(), Values()};
  const auto columns = static_cast<Eigen::Index>(count);
  form.momentum.resize(kTipParameters, columns);
  form.pull.resize(kTipParameters, columns);
  const Vec3& v_tip = links.v[count - 1];
  const Vec3& omega_tip = links.omega[count - 1];
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Vec3& axis = links.axis[i];
    const Vec3 turn = links.omega[i].cross(axis);
    // What P is multiplied with in p and in the pull, and what the first moment is.
    Vec3 p_of_linear = axis;
    Vec3 pull_of_linear = turn;
    Vec3 p_of_moment = Vec3::Zero();
    Vec3 pull_of_moment = Vec3::Zero();
    Scalar weight{};  // pull of 1 kg at the link's origin by gravity
    if (model.bodies[i].type == JointType::kRevolute) {
      const Vec3 arm = links.origin[count - 1] - links.origin[i];
      const Vec3 of_gravity = model.gravity.cross(axis);
      p_of_linear = axis.cross(arm);
      pull_of_linear = links.v[i].cross(axis) + turn.cross(arm);
      p_of_moment = v_tip.cross(axis);
      pull_of_moment = v_tip.cross(turn) + of_gravity;
      weight = arm.dot(of_gravity);
    } else {
      weight = axis.dot(model.gravity);
    }
    p_of_moment += p_of_linear.cross(omega_tip);
    pull_of_moment += pull_of_linear.cross(omega_tip);
    form.momentum(0, column) = v_tip.dot(p_of_linear);
    form.pull(0, column) = v_tip.dot(pull_of_linear) + weight;
    form.momentum.col(column).template tail<3>() =
        detail::rotated_back<Scalar>(links.tip, p_of_moment);
    form.pull.col(column).template tail<3>() =
        detail::rotated_back<Scalar>(links.tip, pull_of_moment);
  }
  return form;
}

}  // namespace offnominal
