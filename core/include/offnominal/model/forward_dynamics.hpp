#pragma once

#include <Eigen/Core>
#include <offnominal/finite.hpp>
#include <offnominal/model/cholesky.hpp>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/mass_matrix.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// What the model says at one instant.
template <int N, typename Scalar>
struct ForwardDynamics {
  Vector<N, Scalar> ddq = zeros<N, Scalar>();                        // rad/s^2 or m/s^2
  Matrix<N, N, Scalar> inertia = no_values<Matrix<N, N, Scalar>>();  // M(q)
  Matrix<N, N, Scalar> factor = no_values<Matrix<N, N, Scalar>>();  // lower, M(q) = factor factor^T
  // What the drive has to be told per torque more on inertia and weight, at this load; 1 without
  // effects on the torque's way.
  Vector<N, Scalar> told_per_load = ones<N, Scalar>();
};

// ddq = M(q)^-1 (load_torque(tau) - V(q, dq) dq - G(q)): the paper's f with the known effects. The
// inverse of inverse_dynamics(). Solves for the vector, the inverse is never formed.
// kSingularMassMatrix where M(q) is not positive definite to rounding, or not finite; `result` is
// then unchanged. `at`: of q.
template <int N, typename Scalar>
[[nodiscard]] Status forward_dynamics(const RigidBodyModel<N, Scalar>& model,
                                      const JointTransforms<N, Scalar>& at,
                                      const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                      const Vector<N, Scalar>& tau, double time_s,
                                      ForwardDynamics<N, Scalar>& result) {
  const Matrix<N, N, Scalar> inertia = mass_matrix(model, at);
  Matrix<N, N, Scalar> factor;
  if (!cholesky<N, Scalar>(inertia, factor)) return Status::kSingularMassMatrix;
  const JointEffects<N, Scalar> effects = joint_effects(model, q, dq, time_s);
  const Vector<N, Scalar> load = load_torque(model, effects, tau);
  Vector<N, Scalar> ddq = load - rigid_body_bias(model, at, dq);
  solve_in_place<N, Scalar>(factor, ddq);
  if (!all_finite(ddq)) return Status::kSingularMassMatrix;
  result.ddq = ddq;
  result.inertia = inertia;
  result.factor = factor;
  result.told_per_load = told_per_load(model, effects, load);
  return Status::kOk;
}
template <int N, typename Scalar>
[[nodiscard]] Status forward_dynamics(const RigidBodyModel<N, Scalar>& model,
                                      const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                      const Vector<N, Scalar>& tau, double time_s,
                                      ForwardDynamics<N, Scalar>& result) {
  return forward_dynamics(model, joint_transforms(model, q), q, dq, tau, time_s, result);
}

}  // namespace offnominal
