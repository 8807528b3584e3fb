#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/model/sine_cosine.hpp>

namespace offnominal {

// Placement of every link's frame in the frame before it at one position of the joints.
template <int N, typename Scalar>
struct JointTransforms {
  PerJoint<N, Matrix<3, 3, Scalar>> rotation;  // child to parent
  PerJoint<N, Vector<3, Scalar>> origin;       // m, parent's frame
};

namespace detail {

// m v, and m^T v. Written out: as Eigen's product each of them is a call.
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<3, Scalar> times(const Matrix<3, 3, Scalar>& m,
                                                          const Vector<3, Scalar>& v) {
  return {m(0, 0) * v[0] + (m(0, 1) * v[1] + m(0, 2) * v[2]),
          m(1, 0) * v[0] + (m(1, 1) * v[1] + m(1, 2) * v[2]),
          m(2, 0) * v[0] + (m(2, 1) * v[1] + m(2, 2) * v[2])};
}
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<3, Scalar> transposed_times(const Matrix<3, 3, Scalar>& m,
                                                                     const Vector<3, Scalar>& v) {
  return {m(0, 0) * v[0] + (m(1, 0) * v[1] + m(2, 0) * v[2]),
          m(0, 1) * v[0] + (m(1, 1) * v[1] + m(2, 1) * v[2]),
          m(0, 2) * v[0] + (m(1, 2) * v[1] + m(2, 2) * v[2])};
}
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<3, Scalar> rotated(const Matrix<3, 3, Scalar>& rotation,
                                                            const Vector<3, Scalar>& v) {
  return times<Scalar>(rotation, v);
}
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<3, Scalar> rotated_back(
    const Matrix<3, 3, Scalar>& rotation, const Vector<3, Scalar>& v) {
  return transposed_times<Scalar>(rotation, v);
}

}  // namespace detail

// q: rad or m. A non-finite q gives non-finite transforms.
template <int N, typename Scalar>
void joint_transforms(const RigidBodyModel<N, Scalar>& model, const Vector<N, Scalar>& q,
                      JointTransforms<N, Scalar>& at) {
  if constexpr (N == kRuntimeJoints) {
    at.rotation.assign(model.bodies.size(), Matrix<3, 3, Scalar>::Zero());
    at.origin.assign(model.bodies.size(), Vector<3, Scalar>::Zero());
  }
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const auto& body = model.bodies[i];
    const Scalar qi = q[static_cast<Eigen::Index>(i)];
    if (body.type == JointType::kRevolute) {
      const SineCosine<Scalar> turn = sine_cosine(qi);
      at.rotation[i] = body.fixed + turn.sine * body.sine + turn.cosine * body.cosine;
      at.origin[i] = body.origin;
    } else {
      at.rotation[i] = body.fixed;
      at.origin[i] = body.origin + qi * body.slide;
    }
  }
}
template <int N, typename Scalar>
[[nodiscard]] JointTransforms<N, Scalar> joint_transforms(const RigidBodyModel<N, Scalar>& model,
                                                          const Vector<N, Scalar>& q) {
  JointTransforms<N, Scalar> at;
  joint_transforms(model, q, at);
  return at;
}

}  // namespace offnominal
