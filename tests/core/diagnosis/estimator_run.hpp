#pragma once

#include <Eigen/Core>
#include <cmath>
#include <offnominal/diagnosis/estimator.hpp>

#include "core/diagnosis/plain_estimator.hpp"

// A motion in closed form with a known fault in it, the nominal model that it departs from, and the
// glue between the product's estimator and the plain one.

namespace offnominal::test {

// A nominal model, smooth, nonlinear, coupled.
inline Eigen::VectorXd example_nominal(const PlainSample& at) {
  const Eigen::ArrayXd restoring =
      2 * at.q.array() + 0.5 * at.dq.array() - 0.2 * at.q.array().sin();
  return (at.tau.array() - restoring + 0.1 * at.dq.sum()).matrix();
}

// Sines in every joint; from fault_time_s on, a nonlinear fault grows that the torque does not
// explain. The uncertainty stays below mu_bar.
struct ExampleMotion {
  int joints = 1;
  double fault_time_s = 2;

  PlainSample sample(double t) const {
    PlainSample at;
    at.q.resize(joints);
    at.dq.resize(joints);
    at.tau.setZero(joints);
    Eigen::VectorXd ddq(joints);
    Eigen::VectorXd unexplained(joints);
    for (int i = 0; i < joints; ++i) {
      const double amplitude = 0.3 + 0.05 * i;
      const double rate = 1.2 + 0.4 * i;
      at.q[i] = amplitude * std::sin(rate * t + i);
      at.dq[i] = amplitude * rate * std::cos(rate * t + i);
      ddq[i] = -amplitude * rate * rate * std::sin(rate * t + i);
      const double profile = t < fault_time_s ? 0 : 1 - std::exp(-(t - fault_time_s));
      const double fault = 4 + 6 * std::sin(3 * at.q[i]) + 3 * at.dq[i] * at.dq[i];
      unexplained[i] = 0.3 / std::sqrt(joints) * std::sin(7 * t + i) + profile * fault;
    }
    at.tau = ddq - unexplained - example_nominal(at);
    at.nominal = example_nominal(at);
    at.mu_bar = 0.4 * (1 + at.dq.norm());
    return at;
  }
};

template <int N, typename Scalar>
NetworkInput<N, Scalar> to_input(const PlainSample& sample) {
  return network_input<N, Scalar>(sample.q.template cast<Scalar>(),
                                  sample.dq.template cast<Scalar>(),
                                  sample.tau.template cast<Scalar>());
}

template <int N, typename Scalar>
EstimatorInput<N, Scalar> estimator_input(const PlainSample& sample) {
  return {to_input<N, Scalar>(sample), sample.nominal.template cast<Scalar>(),
          static_cast<Scalar>(sample.mu_bar)};
}

template <int N, int L, typename Scalar>
Status reset_at(const EstimatorConfig<Scalar>& config, const PlainSample& sample,
                EstimatorState<N, L, Scalar>& state) {
  return reset(config, estimator_input<N, Scalar>(sample), state);
}

// theta in the plain estimator's order: `hidden` units of W1 row by row, W2 column by column.
template <int N, int L, typename Scalar>
Eigen::VectorXd theta_of(const NetworkWeights<N, L, Scalar>& weights, int hidden) {
  constexpr int kInputs = kNetworkInputs<N>;
  Eigen::VectorXd theta((kInputs + N) * hidden);
  for (Eigen::Index unit = 0; unit < hidden; ++unit) {
    theta.segment(unit * kInputs, kInputs) =
        weights.w1.row(unit).transpose().template cast<double>();
    theta.segment(kInputs * hidden + unit * N, N) =
        weights.w2_transposed.row(unit).transpose().template cast<double>();
  }
  return theta;
}

// |theta| of all that is stored, in double.
template <int N, int L, typename Scalar>
double weight_norm(const NetworkWeights<N, L, Scalar>& weights) {
  return std::sqrt(weights.w1.template cast<double>().squaredNorm() +
                   weights.w2_transposed.template cast<double>().squaredNorm());
}

// Replaces the weights of a state that is between two ticks, with all that depends on them.
template <int N, int L, typename Scalar>
void set_weights(const NetworkWeights<N, L, Scalar>& weights, EstimatorState<N, L, Scalar>& state) {
  state.weights = weights;
  state.theta_squared_norm = squared_norm(weights);
  state.w1_z = (weights.w1 * state.z).array();
  state.sigma = sigmoid(state.w1_z);
  state.psi_hat = network_output(weights, state.z);
}

}  // namespace offnominal::test
