#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <offnominal/diagnosis/estimator_state.hpp>
#include <offnominal/diagnosis/network.hpp>
#include <offnominal/diagnosis/tick_integrator.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>

// The nonlinear estimator and its learning law, paper eqs. (2), (7), (8), (9):
//   omega' = -alpha omega + alpha dq + f(q, dq, tau) + psi_hat,   e = dq - omega
//   mu'    = -alpha mu + mu_bar(q, dq, tau)
//   theta' = P{ Gamma Z^T D[e] }, projected to |theta| <= M
// or, in TorqueSpace, the same with the momentum p and its rate in place of dq and f, and with mu,
// mu_bar and D joint by joint.
// One classical Runge-Kutta step of the whole state per tick. Inside the tick the measured signals
// q, dq, tau and what follows from them at a sample, f and mu_bar, are linear between its two ends.
// What f and mu_bar were at the tick's beginning may be said anew, for a torque that jumped there.
// (Evaluating f at interpolated measurements instead would differ in the order of the
// interpolation's own error, and would double the cost of the dynamics.)

namespace offnominal {

namespace detail {

// A number, and no square that comes near to the scalar's largest number.
template <typename Scalar>
[[nodiscard]] constexpr bool is_within(const Scalar& square) {
  return is_finite(square) && square <= std::numeric_limits<Scalar>::max() / 64;
}
template <typename Scalar, int N, int Options, int Most>
[[nodiscard]] bool is_within(const Eigen::Matrix<Scalar, N, 1, Options, Most, 1>& values) {
  return is_within(squared_length(values));
}

// Whether a tick can begin or end with it: otherwise the numbers that come of it are none.
template <int N, typename Scalar, typename Space>
[[nodiscard]] bool is_bounded(const EstimatorInput<N, Scalar, Space>& input,
                              Scalar z_squared_norm) {
  bool bounded = is_within(z_squared_norm) && is_within(squared_length(input.nominal_rate)) &&
                 is_within(input.mu_bar);
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    bounded = bounded && is_within(input.measured.momentum);
  }
  return bounded;
}

// Puts a sample, and what the network makes of it, where the next tick looks for its beginning.
template <int N, int L, typename Scalar, typename Space>
void begin_at(const EstimatorInput<N, Scalar, Space>& sample,
              EstimatorState<N, L, Scalar, Space>& state) {
  state.z = sample.z;
  state.z_squared_norm = squared_norm_of_input<N, Scalar>(sample.z);
  state.nominal_rate = sample.nominal_rate;
  state.mu_bar = sample.mu_bar;
  state.measured = sample.measured;
  first_layer(state.weights, sample.z, state.w1_z);
  state.sigma = sigmoid(state.w1_z);
}

// Adds `jump` to mu, and more where e, within mu as it `was`, has been moved beyond it by rounding.
template <typename Values>
void raise_threshold(const Values& was, const Values& e, typename Values::Scalar jump,
                     typename Values::Scalar& mu) {
  const bool within = length(was) <= mu;
  mu += jump;
  if (within) mu = Eigen::numext::maxi(mu, length(e));
}
template <typename Values>
void raise_threshold(const Values& was, const Values& e, const Values& jump, Values& mu) {
  for (Eigen::Index i = 0; i < mu.size(); ++i) {
    const bool within = Eigen::numext::abs(was[i]) <= mu[i];
    mu[i] += jump[i];
    if (within) mu[i] = Eigen::numext::maxi(mu[i], Eigen::numext::abs(e[i]));
  }
}

}  // namespace detail

// Starts at a sample: omega(0) = dq(0), mu(0) = 0, W2(0) = 0 and seeded W1(0).
// kInvalidInitialWeights where |theta(0)| would not lie inside the ball of radius M,
// kNumericOverflow where the sample is so large that no tick could begin with it; `state` is then
// unchanged.
template <int N, int L, typename Scalar, typename Space>
[[nodiscard]] Status reset(const EstimatorConfig<Scalar>& config,
                           const EstimatorInput<N, Scalar, Space>& sample,
                           EstimatorState<N, L, Scalar, Space>& state) {
  if (!detail::is_bounded(sample, squared_norm_of_input<N, Scalar>(sample.z)))
    return Status::kNumericOverflow;
  const Eigen::Index joints = sample.nominal_rate.size();
  const Scalar squared = initial_squared_norm<N, L, Scalar>(
      config.seed, config.hidden_units, config.initial_weight_range, static_cast<int>(joints));
  if (!is_finite(squared) || std::sqrt(squared) >= config.weight_radius) {
    return Status::kInvalidInitialWeights;
  }
  // In place: on a controller's stack there is no room for another state.
  set_initial_weights(config.seed, config.hidden_units, config.initial_weight_range, state.weights,
                      joints);
  state.theta_squared_norm = squared_norm(state.weights);
  state.omega = detail::measured_at<N, Scalar, Space>(sample);
  state.mu = Space::template no_threshold<N, Scalar>(joints);
  state.error.setZero(joints);
  state.psi_hat.setZero(joints);
  detail::begin_at(sample, state);
  return Status::kOk;
}

// Goes on at a sample after a gap without any: but for rounding e, mu and theta are those before
// the gap, and omega is moved to the new velocity for it, as if no time had passed. No e that was
// within mu is beyond it then. `mu_jump` >= 0 comes on top of mu, for what the velocity's own error
// puts into omega there. kNumericOverflow as reset().
template <int N, int L, typename Scalar, typename Space>
[[nodiscard]] Status resume(const EstimatorInput<N, Scalar, Space>& sample,
                            const typename Space::template Threshold<N, Scalar>& mu_jump,
                            EstimatorState<N, L, Scalar, Space>& state) {
  if (!detail::is_bounded(sample, squared_norm_of_input<N, Scalar>(sample.z)))
    return Status::kNumericOverflow;
  detail::begin_at(sample, state);
  const Vector<N, Scalar> was = state.error;
  state.omega = detail::measured_at<N, Scalar, Space>(sample) - was;
  // What the next tick begins with: y - (y - e) is not e to the bit.
  state.error = detail::measured_at<N, Scalar, Space>(sample) - state.omega;
  detail::raise_threshold(was, state.error, mu_jump, state.mu);
  state.psi_hat = network_output(state.weights, state.sigma);
  return Status::kOk;
}

// Advances the estimator by one tick that begins with `begin`. kNumericOverflow where the input is
// so large that the result would not be finite; `state` is then unchanged. |theta| <= M holds
// afterwards, always.
template <int N, int L, typename Scalar, typename Space>
[[nodiscard]] Status step(const EstimatorConfig<Scalar>& config,
                          const TickBegin<N, Scalar, Space>& begin,
                          const EstimatorInput<N, Scalar, Space>& input,
                          EstimatorState<N, L, Scalar, Space>& state) {
  detail::TickIntegrator<N, L, Scalar, Space> tick(config, begin, input, state);
  const detail::TickEnd<N, Scalar, Space> end = tick.integrate();
  const Scalar reach = tick.squared_reach(end.theta);
  const bool bounded =
      detail::is_bounded(input, tick.input_products().z11) && detail::is_within(reach) &&
      detail::is_within(detail::squared_length(end.omega)) && detail::is_within(end.mu);
  if (!bounded) return Status::kNumericOverflow;
  tick.finish(end.theta, reach, state);
  state.omega = end.omega;
  state.mu = end.mu;
  state.z = input.z;
  state.nominal_rate = input.nominal_rate;
  state.mu_bar = input.mu_bar;
  state.measured = input.measured;
  state.error = detail::measured_at<N, Scalar, Space>(input) - state.omega;
  return Status::kOk;
}

// The same for a tick that begins with what the one before it ended with.
template <int N, int L, typename Scalar, typename Space>
[[nodiscard]] Status step(const EstimatorConfig<Scalar>& config,
                          const EstimatorInput<N, Scalar, Space>& input,
                          EstimatorState<N, L, Scalar, Space>& state) {
  return step(config, TickBegin<N, Scalar, Space>{state.nominal_rate, state.mu_bar}, input, state);
}

}  // namespace offnominal
