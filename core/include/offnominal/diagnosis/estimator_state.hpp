#pragma once

#include <Eigen/Core>
#include <offnominal/diagnosis/network.hpp>
#include <offnominal/diagnosis/space.hpp>
#include <type_traits>

// Units: of the paper's AccelerationSpace; in TorqueSpace N m s (N s) in place of rad/s (m/s), N m
// (N) in place of rad/s^2 (m/s^2).

namespace offnominal {

template <int N, int L, typename Scalar, typename Space = AccelerationSpace>
struct EstimatorState {
  using Threshold = typename Space::template Threshold<N, Scalar>;
  Vector<N, Scalar> omega = zeros<N, Scalar>();  // estimate of dq, rad/s or m/s; or of p
  Threshold mu =
      Space::template no_threshold<N, Scalar>(0);  // of |e| or of each |e_i|, rad/s or m/s
  Vector<N, Scalar> error = zeros<N, Scalar>();    // e, rad/s or m/s
  Vector<N, Scalar> psi_hat = zeros<N, Scalar>();  // fault estimate, rad/s^2 or m/s^2
  NetworkWeights<N, L, Scalar> weights;            // theta

  // The tick's end, which is the next tick's beginning.
  NetworkInput<N, Scalar> z = no_values<NetworkInput<N, Scalar>>();
  Vector<N, Scalar> nominal_rate = zeros<N, Scalar>();  // f, rad/s^2 or m/s^2; or p' of the model
  Threshold mu_bar = Space::template no_threshold<N, Scalar>(0);
  HiddenVector<L, Scalar> w1_z = HiddenVector<L, Scalar>::Zero();   // W1 z
  HiddenVector<L, Scalar> sigma = HiddenVector<L, Scalar>::Zero();  // sigma(W1 z)
  Scalar theta_squared_norm{};                                      // |theta|^2
  Scalar z_squared_norm{};                                          // |z|^2
  [[no_unique_address]] typename Space::template Measured<N, Scalar> measured{};
};

// What the model and the bound say at the beginning of one tick.
template <int N, typename Scalar, typename Space = AccelerationSpace>
struct TickBegin {
  Vector<N, Scalar> nominal_rate;                          // f, rad/s^2 or m/s^2; or p'
  typename Space::template Threshold<N, Scalar> mu_bar{};  // bound, >= 0
};

// The signals at a sample: the end of one tick, or the beginning of the first.
template <int N, typename Scalar, typename Space = AccelerationSpace>
struct EstimatorInput {
  NetworkInput<N, Scalar> z;
  Vector<N, Scalar> nominal_rate;                          // f, rad/s^2 or m/s^2; or p'
  typename Space::template Threshold<N, Scalar> mu_bar{};  // bound, >= 0
  [[no_unique_address]] typename Space::template Measured<N, Scalar> measured{};
};

namespace detail {

// What is filtered, dq or p, at a sample: an input, or the state that it left.
template <int N, typename Scalar, typename Space, typename Sample>
[[nodiscard]] EIGEN_ALWAYS_INLINE decltype(auto) measured_at(const Sample& sample) {
  if constexpr (std::is_same_v<Space, TorqueSpace>) {
    return (sample.measured.momentum);
  } else {
    return velocity_in<N, Scalar>(sample.z);
  }
}

}  // namespace detail

}  // namespace offnominal
