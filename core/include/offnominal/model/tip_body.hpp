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
    const Vec3 arm = rotation.lazyProduct(at.origin[i]);
    origin += arm;
    v += omega.cross(arm);
    const Matrix<3, 3, Scalar> turned = rotation.lazyProduct(at.rotation[i]);
    rotation = turned;
    links.axis[i] = rotation.lazyProduct(body.axis);
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
// same L and P, about its own origin: no way back along the chain. Non-finite input gives
// non-finite output.
template <int N, typename Scalar>
[[nodiscard]] TipBodyForm<N, Scalar> tip_body_form(const RigidBodyModel<N, Scalar>& model,
                                                   const JointTransforms<N, Scalar>& at,
                                                   const Vector<N, Scalar>& dq) {
  using Vec3 = Vector<3, Scalar>;
  const std::size_t count = model.bodies.size();
  detail::BaseMotion<N, Scalar> links;
  detail::move_in_base(model, at, dq, links);
  TipBodyForm<N, Scalar> form;
  const auto columns = static_cast<Eigen::Index>(count);
  form.momentum.resize(kTipParameters, columns);
  form.pull.resize(kTipParameters, columns);
  const std::size_t last = count - 1;
  for (int which = 0; which < kTipParameters; ++which) {
    const bool is_mass = which == 0;
    const Vec3 moment = is_mass ? Vec3(Vec3::Zero()) : Vec3(links.tip.col(which - 1));
    const Scalar mass = is_mass ? Scalar(1) : Scalar(0);
    const Vec3 linear = mass * links.v[last] + links.omega[last].cross(moment);
    const Vec3 about_tip = moment.cross(links.v[last]);
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3& axis = links.axis[i];
      Scalar& momentum = form.momentum(which, static_cast<Eigen::Index>(i));
      Scalar& pull = form.pull(which, static_cast<Eigen::Index>(i));
      if (model.bodies[i].type == JointType::kRevolute) {
        const Vec3 arm = links.origin[last] - links.origin[i];
        const Vec3 angular = about_tip + arm.cross(linear);
        const Vec3 first_moment = moment + mass * arm;
        momentum = axis.dot(angular);
        pull = axis.dot(angular.cross(links.omega[i]) + linear.cross(links.v[i]) +
                        first_moment.cross(model.gravity));
      } else {
        momentum = axis.dot(linear);
        pull = axis.dot(linear.cross(links.omega[i]) + mass * model.gravity);
      }
    }
  }
  return form;
}

}  // namespace offnominal
