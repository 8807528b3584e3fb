#pragma once

#include <Eigen/Core>
#include <offnominal/diagnosis/network.hpp>

namespace offnominal {

template <int N, int L, typename Scalar>
struct EstimatorState {
  Vector<N, Scalar> omega = zeros<N, Scalar>();    // velocity estimate, rad/s or m/s
  Scalar mu{};                                     // threshold of |e|, rad/s or m/s
  Vector<N, Scalar> error = zeros<N, Scalar>();    // e, rad/s or m/s
  Vector<N, Scalar> psi_hat = zeros<N, Scalar>();  // fault estimate, rad/s^2 or m/s^2
  NetworkWeights<N, L, Scalar> weights;            // theta

  // The tick's end, which is the next tick's beginning.
  NetworkInput<N, Scalar> z = no_values<NetworkInput<N, Scalar>>();
  Vector<N, Scalar> nominal_ddq = zeros<N, Scalar>();  // f, rad/s^2 or m/s^2
  Scalar mu_bar{};
  HiddenVector<L, Scalar> w1_z = HiddenVector<L, Scalar>::Zero();   // W1 z
  HiddenVector<L, Scalar> sigma = HiddenVector<L, Scalar>::Zero();  // sigma(W1 z)
  Scalar theta_squared_norm{};                                      // |theta|^2
  Scalar z_squared_norm{};                                          // |z|^2
};

// What the model and the bound say at the beginning of one tick.
template <int N, typename Scalar>
struct TickBegin {
  Vector<N, Scalar> nominal_ddq;  // f, rad/s^2 or m/s^2
  Scalar mu_bar{};                // bound, >= 0
};

// The signals at a sample: the end of one tick, or the beginning of the first.
template <int N, typename Scalar>
struct EstimatorInput {
  NetworkInput<N, Scalar> z;
  Vector<N, Scalar> nominal_ddq;  // f, rad/s^2 or m/s^2
  Scalar mu_bar{};                // bound, >= 0
};

}  // namespace offnominal
