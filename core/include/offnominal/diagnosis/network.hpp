#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <offnominal/diagnosis/lanes.hpp>
#include <offnominal/diagnosis/sigmoid.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/status.hpp>

// The paper's three-layer sigmoidal network, eq. (4): psi_hat = W2 sigma(W1 z), z = [1 q dq tau].

namespace offnominal {

// Network inputs of n joints: 1, q, dq, tau.
template <int N>
inline constexpr int kNetworkInputs = N == kRuntimeJoints ? kRuntimeJoints : 3 * N + 1;
template <int N>
inline constexpr int kMostNetworkInputs = kNetworkInputs<kMostJoints<N>>;

template <int L, typename Scalar>
using HiddenVector = Eigen::Array<Scalar, kHiddenRows<L, Scalar>, 1>;

template <int N, typename Scalar>
using NetworkInput =
    Eigen::Matrix<Scalar, kNetworkInputs<N>, 1, Eigen::AutoAlign, kMostNetworkInputs<N>, 1>;

// Their inner product, and the joints' velocities among them.
template <int N, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Scalar dot_of_inputs(const NetworkInput<N, Scalar>& z,
                                                       const NetworkInput<N, Scalar>& other) {
  return detail::dot<kNetworkInputs<1>, 3>(z, other);
}
template <int N, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Scalar squared_norm_of_input(const NetworkInput<N, Scalar>& z) {
  return detail::squared_length<kNetworkInputs<1>, 3>(z);
}
template <int N, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE auto velocity_in(const NetworkInput<N, Scalar>& z) {
  if constexpr (N == kRuntimeJoints) {
    const Eigen::Index joints = (z.size() - 1) / 3;
    return z.segment(1 + joints, joints);
  } else {
    return z.template segment<N>(1 + N);
  }
}

// theta of the paper. L is the capacity: a hidden unit whose weights are all zero stays so under
// the learning law (sigma(0) = 0, so its output weights have no gradient, and without output
// weights its input weights have none), so that fewer units than L are exactly a smaller network.
template <int N, int L, typename Scalar>
struct NetworkWeights {
  static constexpr int kRows = kHiddenRows<L, Scalar>;
  using InputWeights = Eigen::Matrix<Scalar, kRows, kNetworkInputs<N>,
                                     Matrix<kRows, kMostNetworkInputs<N>, Scalar>::Options, kRows,
                                     kMostNetworkInputs<N>>;
  using OutputWeights = Matrix<kRows, N, Scalar>;
  InputWeights w1 = no_values<InputWeights>();
  OutputWeights w2_transposed = no_values<OutputWeights>();
};

template <int N, typename Scalar>
[[nodiscard]] NetworkInput<N, Scalar> network_input(const Vector<N, Scalar>& q,
                                                    const Vector<N, Scalar>& dq,
                                                    const Vector<N, Scalar>& tau) {
  NetworkInput<N, Scalar> z;
  if constexpr (N == kRuntimeJoints) {
    const Eigen::Index joints = q.size();
    z.resize(1 + 3 * joints);
    z << Scalar(1), q, dq, tau;
  } else {
    z[0] = Scalar(1);
    z.template segment<N>(1) = q;
    z.template segment<N>(1 + N) = dq;
    z.template segment<N>(1 + 2 * N) = tau;
  }
  return z;
}

// The initial weights of W1, row by row, uniform in [-range, range], from SplitMix32 (G. L. Steele
// et al., OOPSLA 2014; 32-bit constants of C. Wellons): the same seed gives the same weights for
// every scalar and machine, to the scalar's rounding.
template <typename Scalar>
class InitialWeights {
 public:
  InitialWeights(std::uint32_t seed, Scalar range) : state_(seed), range_(range) {}

  [[nodiscard]] Scalar next() {
    state_ += 0x9E3779B9U;
    std::uint32_t bits = state_;
    bits = (bits ^ (bits >> 16U)) * 0x21F0AAADU;
    bits = (bits ^ (bits >> 15U)) * 0x735A2D97U;
    bits ^= bits >> 15U;
    // 24 bits are exact in float: [-1, 1) in steps of 2^-23.
    const auto whole = static_cast<std::int32_t>(bits >> 8U) - (1 << 23);
    return range_ * (static_cast<Scalar>(whole) / Scalar(1 << 23));
  }

 private:
  std::uint32_t state_;
  Scalar range_;
};

// W2(0) = 0, so that psi_hat = 0 (eq. 6); W1(0) of InitialWeights in the first `hidden_units` rows,
// at most L; the rest zero. `joints`: of a network whose compiler does not know it.
template <int N, int L, typename Scalar>
void set_initial_weights(std::uint32_t seed, int hidden_units, Scalar range,
                         NetworkWeights<N, L, Scalar>& weights, Eigen::Index joints = N) {
  weights.w1.setZero(weights.w1.rows(), 3 * joints + 1);
  weights.w2_transposed.setZero(weights.w1.rows(), joints);
  InitialWeights<Scalar> sequence(seed, range);
  for (Eigen::Index unit = 0; unit < hidden_units && unit < L; ++unit) {
    for (Eigen::Index input = 0; input < weights.w1.cols(); ++input) {
      weights.w1(unit, input) = sequence.next();
    }
  }
}
template <int N, int L, typename Scalar>
[[nodiscard]] NetworkWeights<N, L, Scalar> initial_weights(std::uint32_t seed, int hidden_units,
                                                           Scalar range, Eigen::Index joints = N) {
  NetworkWeights<N, L, Scalar> weights;
  set_initial_weights(seed, hidden_units, range, weights, joints);
  return weights;
}

// |theta(0)|^2 of such weights, without room for them.
template <int N, int L, typename Scalar>
[[nodiscard]] Scalar initial_squared_norm(std::uint32_t seed, int hidden_units, Scalar range,
                                          int joints = N) {
  InitialWeights<Scalar> sequence(seed, range);
  Scalar sum(0);
  for (int i = std::min(hidden_units, L) * (3 * joints + 1); i > 0; --i) {
    const Scalar weight = sequence.next();
    sum += weight * weight;
  }
  return sum;
}

namespace detail {

// take(row, W1 z of the block that begins there), block by block.
template <int N, int L, typename Scalar, typename Take>
EIGEN_ALWAYS_INLINE void first_layer(const NetworkWeights<N, L, Scalar>& weights,
                                     const NetworkInput<N, Scalar>& z, const Take& take) {
  for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
    Block<Scalar> sum = z[0] * load(&weights.w1(row, 0));
    repeat<kNetworkInputs<N> - 1>(
        z.size() - 1, [&](int i) __attribute__((always_inline)) {
          sum += z[i + 1] * load(&weights.w1(row, i + 1));
        });
    take(row, sum);
  });
}

}  // namespace detail

// W1 z.
template <int N, int L, typename Scalar>
EIGEN_ALWAYS_INLINE void first_layer(const NetworkWeights<N, L, Scalar>& weights,
                                     const NetworkInput<N, Scalar>& z,
                                     HiddenVector<L, Scalar>& w1_z) {
  detail::first_layer<N, L, Scalar>(
      weights, z, [&](int row, const detail::Block<Scalar>& sum) __attribute__((always_inline)) {
        detail::store<Scalar>(sum, &w1_z[row]);
      });
}

// psi_hat, rad/s^2 or m/s^2, of the hidden units' values.
template <int N, int L, typename Scalar>
[[nodiscard]] Vector<N, Scalar> network_output(const NetworkWeights<N, L, Scalar>& weights,
                                               const HiddenVector<L, Scalar>& sigma) {
  Vector<N, Scalar> psi_hat;
  psi_hat.resize(weights.w2_transposed.cols());
  for (Eigen::Index k = 0; k < psi_hat.size(); ++k) {
    detail::Block<Scalar> sum{};
    detail::for_each_block<Scalar, L>([&](int row) __attribute__((always_inline)) {
      sum += detail::load(&sigma[row]) * detail::load(&weights.w2_transposed(row, k));
    });
    psi_hat[k] = detail::total<Scalar>(sum);
  }
  return psi_hat;
}

// psi_hat at input z.
template <int N, int L, typename Scalar>
[[nodiscard]] Vector<N, Scalar> network_output(const NetworkWeights<N, L, Scalar>& weights,
                                               const NetworkInput<N, Scalar>& z) {
  HiddenVector<L, Scalar> pre;
  first_layer(weights, z, pre);
  const HiddenVector<L, Scalar> sigma = sigmoid(pre);
  return network_output(weights, sigma);
}

// |theta|^2.
template <int N, int L, typename Scalar>
[[nodiscard]] Scalar squared_norm(const NetworkWeights<N, L, Scalar>& weights) {
  detail::Block<Scalar> sum{};
  const auto add = [&](const auto& matrix) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      detail::for_each_block<Scalar, L>([&](int row) __attribute__((always_inline)) {
        const detail::Block<Scalar> w = detail::load(&matrix(row, column));
        sum += w * w;
      });
    }
  };
  add(weights.w1);
  add(weights.w2_transposed);
  return detail::total<Scalar>(sum);
}

}  // namespace offnominal
