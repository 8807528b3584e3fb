#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <offnominal/model/inverse_dynamics.hpp>
#include <offnominal/model/mass_matrix.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// What the model says at one instant.
template <int N, typename Scalar>
struct ForwardDynamics {
  Vector<N, Scalar> ddq = Vector<N, Scalar>::Zero();            // rad/s^2 or m/s^2
  Matrix<N, N, Scalar> inertia = Matrix<N, N, Scalar>::Zero();  // M(q)
  Matrix<N, N, Scalar> factor = Matrix<N, N, Scalar>::Zero();   // lower, M(q) = factor factor^T
  // What the drive has to be told per torque more on inertia and weight, at this load; 1 without
  // effects on the torque's way.
  Vector<N, Scalar> told_per_load = Vector<N, Scalar>::Ones();
};

// x = M(q)^-1 x with the factor that forward_dynamics() gives for q.
template <int N, typename Scalar>
void solve_in_place(const Matrix<N, N, Scalar>& factor, Vector<N, Scalar>& x) {
  factor.template triangularView<Eigen::Lower>().solveInPlace(x);
  factor.transpose().template triangularView<Eigen::Upper>().solveInPlace(x);
}

// ddq = M(q)^-1 (load_torque(tau) - V(q, dq) dq - G(q)): the paper's f with the known effects. The
// inverse of inverse_dynamics(). Solves for the vector, the inverse is never formed.
// kSingularMassMatrix where M(q) is not positive definite to rounding, or not finite; `result` is
// then unchanged.
template <int N, typename Scalar>
[[nodiscard]] Status forward_dynamics(const RigidBodyModel<N, Scalar>& model,
                                      const Vector<N, Scalar>& q, const Vector<N, Scalar>& dq,
                                      const Vector<N, Scalar>& tau, Scalar time_s,
                                      ForwardDynamics<N, Scalar>& result) {
  const JointTransforms<N, Scalar> at = joint_transforms(model, q);
  const Matrix<N, N, Scalar> inertia = mass_matrix(model, at);
  const Eigen::LLT<Matrix<N, N, Scalar>> factor(inertia);
  if (factor.info() != Eigen::Success) return Status::kSingularMassMatrix;
  const JointEffects<N, Scalar> effects = joint_effects(model, q, dq, time_s);
  const Vector<N, Scalar> load = load_torque(model, effects, tau);
  Vector<N, Scalar> ddq = load - rigid_body_bias(model, at, dq);
  factor.solveInPlace(ddq);
  // A NaN on the diagonal passes the factor's own test.
  if (!ddq.allFinite()) return Status::kSingularMassMatrix;
  result.ddq = ddq;
  result.inertia = inertia;
  result.factor = factor.matrixL();
  result.told_per_load = told_per_load(model, effects, load);
  return Status::kOk;
}

}  // namespace offnominal
