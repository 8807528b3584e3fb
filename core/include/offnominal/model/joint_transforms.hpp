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

// q: rad or m. A non-finite q gives non-finite transforms.
template <int N, typename Scalar>
[[nodiscard]] JointTransforms<N, Scalar> joint_transforms(const RigidBodyModel<N, Scalar>& model,
                                                          const Vector<N, Scalar>& q) {
  JointTransforms<N, Scalar> at;
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
  return at;
}

}  // namespace offnominal
