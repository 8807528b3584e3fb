#pragma once

#include <Eigen/Core>
#include <offnominal/model/cholesky.hpp>
#include <offnominal/model/rigid_body_model.hpp>

namespace offnominal {

template <int N, typename Scalar>
struct CompensatingTorque {
  Vector<N, Scalar> torque = zeros<N, Scalar>();  // to be added to the command, N m or N
  bool saturated = false;                         // a joint's limit was reached
};

// Takes away `load`, what acts on the joints beside the model (psi_hat of TorqueSpace), N m or N.
// Every joint clamped to +-limit; told_per_load as below. NaN in, NaN out.
template <int N, typename Scalar>
[[nodiscard]] CompensatingTorque<N, Scalar> compensating_torque_of_load(
    const Vector<N, Scalar>& load, const Vector<N, Scalar>& limit,
    const Vector<N, Scalar>& told_per_load) {
  CompensatingTorque<N, Scalar> result;
  size_for(static_cast<std::size_t>(limit.size()), result.torque);
  const Vector<N, Scalar> wanted = -told_per_load.cwiseProduct(load);
  for (Eigen::Index i = 0; i < limit.size(); ++i) {
    const Scalar w = wanted[i];
    const bool over = w > limit[i];
    const bool under = w < -limit[i];
    result.torque[i] = over ? limit[i] : under ? -limit[i] : w;
    result.saturated = result.saturated || over || under;
  }
  return result;
}

// Accommodation, paper eq. (31): tau_r = tau + torque with torque = -M(q) psi_hat, every joint
// clamped to +-limit (N m or N, >= 0). psi_hat in rad/s^2 or m/s^2. told_per_load (1 in the paper):
// what a drive has to be told for 1 N m more behind its gear, ForwardDynamics::told_per_load; exact
// while the compensation does not turn the load's sign. NaN in, NaN out.
template <int N, typename Scalar>
[[nodiscard]] CompensatingTorque<N, Scalar> compensating_torque(
    const Matrix<N, N, Scalar>& inertia, const Vector<N, Scalar>& psi_hat,
    const Vector<N, Scalar>& limit, const Vector<N, Scalar>& told_per_load) {
  return compensating_torque_of_load<N, Scalar>(product<N, Scalar>(inertia, psi_hat), limit,
                                                told_per_load);
}
template <int N, typename Scalar>
[[nodiscard]] CompensatingTorque<N, Scalar> compensating_torque(const Matrix<N, N, Scalar>& inertia,
                                                                const Vector<N, Scalar>& psi_hat,
                                                                const Vector<N, Scalar>& limit) {
  return compensating_torque<N, Scalar>(inertia, psi_hat, limit, ones<N, Scalar>(limit.size()));
}

}  // namespace offnominal
