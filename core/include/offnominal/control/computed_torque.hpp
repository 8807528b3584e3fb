#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <offnominal/finite.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// Diagonals of K_p (1/s^2) and K_d (1/s) of eq. (29), >= 0.
template <int N, typename Scalar>
struct ComputedTorqueGains {
  PerJoint<N, Scalar> kp{};
  PerJoint<N, Scalar> kd{};
};

// Where the joints should be: rad, rad/s, rad/s^2 (m, m/s, m/s^2).
template <int N, typename Scalar>
struct Reference {
  Vector<N, Scalar> q = zeros<N, Scalar>();
  Vector<N, Scalar> dq = zeros<N, Scalar>();
  Vector<N, Scalar> ddq = zeros<N, Scalar>();
};

template <int N, typename Scalar>
[[nodiscard]] Status validate(const ComputedTorqueGains<N, Scalar>& gains) {
  for (std::size_t i = 0; i < gains.kp.size(); ++i) {
    const bool good =
        is_finite(gains.kp[i]) && gains.kp[i] >= 0 && is_finite(gains.kd[i]) && gains.kd[i] >= 0;
    if (!good) return Status::kInvalidGain;
  }
  return Status::kOk;
}

// Computed torque, paper eq. (29): M(q)(ddq_d + K_d (dq_d - dq) + K_p (q_d - q)) + V dq + G, plus
// the effects that the model knows, as the drive has to be told. N m or N, not limited. One
// inverse-dynamics recursion. `at`: of q.
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> computed_torque(const RigidBodyModel<N, Scalar>& model,
                                                const JointTransforms<N, Scalar>& at,
                                                const ComputedTorqueGains<N, Scalar>& gains,
                                                const Reference<N, Scalar>& reference,
                                                const Vector<N, Scalar>& q,
                                                const Vector<N, Scalar>& dq, double time_s) {
  using Diagonal = Eigen::Map<const Vector<N, Scalar>>;
  const Diagonal kp(gains.kp.data(), q.size());
  const Diagonal kd(gains.kd.data(), q.size());
  const Vector<N, Scalar> ddq =
      reference.ddq + kd.cwiseProduct(reference.dq - dq) + kp.cwiseProduct(reference.q - q);
  return inverse_dynamics(model, at, q, dq, ddq, time_s);
}
template <int N, typename Scalar>
[[nodiscard]] Vector<N, Scalar> computed_torque(const RigidBodyModel<N, Scalar>& model,
                                                const ComputedTorqueGains<N, Scalar>& gains,
                                                const Reference<N, Scalar>& reference,
                                                const Vector<N, Scalar>& q,
                                                const Vector<N, Scalar>& dq, double time_s) {
  return computed_torque(model, joint_transforms(model, q), gains, reference, q, dq, time_s);
}

}  // namespace offnominal
