#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <offnominal/diagnosis/gradient_span.hpp>
#include <offnominal/diagnosis/network.hpp>

// The work on the hidden layer inside one tick: one sweep over the hidden units per Runge-Kutta
// stage, in blocks of the processor's vector length, with all inner products of the stage summed on
// the way. Scalars come by value, so that no store to the vectors can make the compiler load them
// again.

namespace offnominal::detail {

template <typename Scalar>
using Block = Eigen::Array<Scalar, kLanes<Scalar>, 1>;

// Factors of the gradients g_j = (b_j z_j^T, D_j sigma_j^T) of the stages so far.
template <int N, int L, typename Scalar>
struct StageFactors {
  std::array<HiddenVector<L, Scalar>, kStages> b;
  std::array<HiddenVector<L, Scalar>, kStages> sigma;
};

// What psi_hat of a stage is made of.
template <int N, typename Scalar>
struct SigmaSums {
  std::array<Scalar, kStages> before{};  // sigma_j . sigma_s, j < s
  Vector<N, Scalar> w2_sigma;            // W2(t0) sigma_s
};

// What the norm of theta is followed with. with_begin stays zero at the last stage, nobody needs it
// there.
template <typename Scalar>
struct GradientSums {
  Scalar sigma_squared{};  // |sigma_s|^2
  Scalar b_squared{};      // |b_s|^2
  Scalar with_theta{};     // b_s . (W1 z_s)
  Scalar with_begin{};     // b_s . (W1(t0) z_s)
};

// W1(t0) z1 and W1(t0) (z0 + z1) / 2.
template <int N, int L, typename Scalar>
EIGEN_ALWAYS_INLINE void first_layer(const NetworkWeights<N, L, Scalar>& weights,
                                     const HiddenVector<L, Scalar>& w1_z0,
                                     const NetworkInput<N, Scalar>& z1,
                                     HiddenVector<L, Scalar>& w1_middle,
                                     HiddenVector<L, Scalar>& w1_z1) {
  constexpr int kWidth = kLanes<Scalar>;
  for (Eigen::Index row = 0; row < kHiddenRows<L, Scalar>; row += kWidth) {
    Block<Scalar> sum = z1[0] * weights.w1.col(0).array().template segment<kWidth>(row);
    for (Eigen::Index input = 1; input < kNetworkInputs<N>; ++input) {
      sum += z1[input] * weights.w1.col(input).array().template segment<kWidth>(row);
    }
    w1_z1.template segment<kWidth>(row) = sum;
    w1_middle.template segment<kWidth>(row) =
        Scalar(0.5) * (sum + w1_z0.template segment<kWidth>(row));
  }
}

// pre = W1 z = keep W1(t0) z + sum kappa_j b_j, w1_z being W1(t0) z, and factors.sigma[Stage] from
// it.
template <int Stage, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE SigmaSums<N, Scalar> sigma_pass(
    const HiddenVector<L, Scalar>& w1_z, const NetworkWeights<N, L, Scalar>& weights, Scalar keep,
    std::array<Scalar, kStages> kappa, StageFactors<N, L, Scalar>& factors,
    HiddenVector<L, Scalar>& pre) {
  constexpr int kWidth = kLanes<Scalar>;
  constexpr auto kStage = static_cast<std::size_t>(Stage);
  using Lanes = Block<Scalar>;
  std::array<Lanes, kStage> before;
  std::array<Lanes, static_cast<std::size_t>(N)> w2_sigma;
  for (Lanes& sum : before) sum.setZero();
  for (Lanes& sum : w2_sigma) sum.setZero();
  for (Eigen::Index row = 0; row < kHiddenRows<L, Scalar>; row += kWidth) {
    const auto block = [row](const HiddenVector<L, Scalar>& x) -> Lanes {
      return x.template segment<kWidth>(row);
    };
    Lanes at = keep * block(w1_z);
    for (std::size_t j = 0; j < kStage; ++j) at += kappa[j] * block(factors.b[j]);
    const Lanes sigma = sigmoid(at);
    pre.template segment<kWidth>(row) = at;
    factors.sigma[kStage].template segment<kWidth>(row) = sigma;
    for (std::size_t j = 0; j < kStage; ++j) before[j] += sigma * block(factors.sigma[j]);
    for (Eigen::Index k = 0; k < N; ++k) {
      w2_sigma[static_cast<std::size_t>(k)] +=
          sigma * weights.w2_transposed.col(k).array().template segment<kWidth>(row);
    }
  }
  SigmaSums<N, Scalar> sums;
  for (std::size_t j = 0; j < kStage; ++j) sums.before[j] = before[j].sum();
  for (Eigen::Index k = 0; k < N; ++k) {
    sums.w2_sigma[k] = w2_sigma[static_cast<std::size_t>(k)].sum();
  }
  return sums;
}

// factors.b[Stage] = (1 - sigma^2) / 2 (W2^T D) with W2^T D / 2 = W2(t0)^T kept_d + sum nu_j
// sigma_j. pre = W1 z and w1_z = W1(t0) z of the stage.
template <int Stage, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE GradientSums<Scalar> gradient_pass(
    const HiddenVector<L, Scalar>& w1_z, const HiddenVector<L, Scalar>& pre,
    const NetworkWeights<N, L, Scalar>& weights, Vector<N, Scalar> kept_d,
    std::array<Scalar, kStages> nu, StageFactors<N, L, Scalar>& factors) {
  constexpr int kWidth = kLanes<Scalar>;
  constexpr auto kStage = static_cast<std::size_t>(Stage);
  constexpr bool kMiddle = Stage > 0 && Stage < kStages - 1;
  using Lanes = Block<Scalar>;
  Lanes sigma_squared = Lanes::Zero();
  Lanes b_squared = Lanes::Zero();
  Lanes with_theta = Lanes::Zero();
  Lanes with_begin = Lanes::Zero();
  for (Eigen::Index row = 0; row < kHiddenRows<L, Scalar>; row += kWidth) {
    const auto block = [row](const HiddenVector<L, Scalar>& x) -> Lanes {
      return x.template segment<kWidth>(row);
    };
    const auto w2 = [&weights, row](Eigen::Index k) -> Lanes {
      return weights.w2_transposed.col(k).array().template segment<kWidth>(row);
    };
    Lanes back = kept_d[0] * w2(0);
    for (Eigen::Index k = 1; k < N; ++k) back += kept_d[k] * w2(k);
    for (std::size_t j = 0; j < kStage; ++j) back += nu[j] * block(factors.sigma[j]);
    const Lanes squared = block(factors.sigma[kStage]).square();
    const Lanes b = back * (Scalar(1) - squared);
    factors.b[kStage].template segment<kWidth>(row) = b;
    sigma_squared += squared;
    b_squared += b * b;
    with_theta += b * block(pre);
    if constexpr (kMiddle) with_begin += b * block(w1_z);
  }
  GradientSums<Scalar> sums{sigma_squared.sum(), b_squared.sum(), with_theta.sum(), Scalar(0)};
  if constexpr (kMiddle) sums.with_begin = with_begin.sum();
  if constexpr (Stage == 0) sums.with_begin = sums.with_theta;
  return sums;
}

// theta <- keep theta + sum gain_j g_j and w1_z <- W1 z1 with it; returns the new |theta|^2. z_j is
// z0 at the first stage, z1 at the last and their mean at the two between, so that
// W1 <- keep W1 + p z0^T + r z1^T. share(k, j) = gain_j D_j[k].
template <int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Scalar
update_weights(SpanPoint<Scalar> point, Matrix<N, kStages, Scalar> share,
               const StageFactors<N, L, Scalar>& factors, const HiddenVector<L, Scalar>& w1_z1,
               const NetworkInput<N, Scalar>& z0, const NetworkInput<N, Scalar>& z1, Scalar z01,
               Scalar z11, NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& w1_z) {
  constexpr int kWidth = kLanes<Scalar>;
  using Lanes = Block<Scalar>;
  // Spread over the lanes once, not once per block.
  std::array<Lanes, static_cast<std::size_t>(kNetworkInputs<N>)> at_begin;
  std::array<Lanes, static_cast<std::size_t>(kNetworkInputs<N>)> at_end;
  for (Eigen::Index input = 0; input < kNetworkInputs<N>; ++input) {
    at_begin[static_cast<std::size_t>(input)].setConstant(z0[input]);
    at_end[static_cast<std::size_t>(input)].setConstant(z1[input]);
  }
  const Scalar half_1 = Scalar(0.5) * point.gain[1];
  const Scalar half_2 = Scalar(0.5) * point.gain[2];
  // One sum per column: a single one would be a chain of dependent additions.
  std::array<Lanes, static_cast<std::size_t>(kNetworkInputs<N> + N)> squares;
  for (Lanes& sum : squares) sum.setZero();
  for (Eigen::Index row = 0; row < kHiddenRows<L, Scalar>; row += kWidth) {
    const auto block = [row](const HiddenVector<L, Scalar>& x) -> Lanes {
      return x.template segment<kWidth>(row);
    };
    const Lanes middle = half_1 * block(factors.b[1]) + half_2 * block(factors.b[2]);
    const Lanes p = point.gain[0] * block(factors.b[0]) + middle;
    const Lanes r = point.gain[3] * block(factors.b[3]) + middle;
    w1_z.template segment<kWidth>(row) = point.keep * block(w1_z1) + z01 * p + z11 * r;
    for (Eigen::Index input = 0; input < kNetworkInputs<N>; ++input) {
      const auto i = static_cast<std::size_t>(input);
      auto w = weights.w1.col(input).array().template segment<kWidth>(row);
      const Lanes updated = point.keep * w + at_begin[i] * p + at_end[i] * r;
      squares[i] += updated * updated;
      w = updated;
    }
    for (Eigen::Index k = 0; k < N; ++k) {
      auto w = weights.w2_transposed.col(k).array().template segment<kWidth>(row);
      Lanes updated = point.keep * w;
      for (Eigen::Index j = 0; j < kStages; ++j) {
        updated += share(k, j) * block(factors.sigma[static_cast<std::size_t>(j)]);
      }
      squares[static_cast<std::size_t>(kNetworkInputs<N> + k)] += updated * updated;
      w = updated;
    }
  }
  Lanes total = Lanes::Zero();
  for (const Lanes& sum : squares) total += sum;
  return total.sum();
}

// theta <- shrink theta, likewise w1_z = W1 z; sigma of it, and psi_hat = W2 sigma.
template <int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<N, Scalar> shrink_and_look(
    Scalar shrink, NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& w1_z,
    HiddenVector<L, Scalar>& sigma) {
  constexpr int kWidth = kLanes<Scalar>;
  using Lanes = Block<Scalar>;
  std::array<Lanes, static_cast<std::size_t>(N)> psi;
  for (Lanes& sum : psi) sum.setZero();
  for (Eigen::Index row = 0; row < kHiddenRows<L, Scalar>; row += kWidth) {
    const Lanes pre = shrink * w1_z.template segment<kWidth>(row);
    const Lanes s = sigmoid(pre);
    w1_z.template segment<kWidth>(row) = pre;
    sigma.template segment<kWidth>(row) = s;
    for (Eigen::Index input = 0; input < kNetworkInputs<N>; ++input) {
      weights.w1.col(input).array().template segment<kWidth>(row) *= shrink;
    }
    for (Eigen::Index k = 0; k < N; ++k) {
      auto w = weights.w2_transposed.col(k).array().template segment<kWidth>(row);
      const Lanes w2 = shrink * w;
      w = w2;
      psi[static_cast<std::size_t>(k)] += s * w2;
    }
  }
  Vector<N, Scalar> psi_hat;
  for (Eigen::Index k = 0; k < N; ++k) psi_hat[k] = psi[static_cast<std::size_t>(k)].sum();
  return psi_hat;
}

}  // namespace offnominal::detail
