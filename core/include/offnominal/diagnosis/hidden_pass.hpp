#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <offnominal/diagnosis/gradient_span.hpp>
#include <offnominal/diagnosis/lanes.hpp>
#include <offnominal/diagnosis/network.hpp>

// The work on the hidden layer inside one tick: one sweep over the hidden units per Runge-Kutta
// stage, in blocks of the processor's vector length, with all inner products of the stage summed on
// the way. Scalars come by value, so that no store to the vectors can make the compiler load them
// again.

namespace offnominal::detail {

// Factors of the gradients g_j = (b_j z_j^T, D_j sigma_j^T) of the stages so far.
template <int L, typename Scalar>
struct StageFactors {
  std::array<HiddenVector<L, Scalar>, kStages> b;
  const HiddenVector<L, Scalar>& sigma_begin;  // of the first stage, known since the last tick
  std::array<HiddenVector<L, Scalar>, kStages - 1> sigma_later;

  [[nodiscard]] EIGEN_ALWAYS_INLINE const HiddenVector<L, Scalar>& sigma(std::size_t stage) const {
    return stage == 0 ? sigma_begin : sigma_later[stage - 1];
  }
};

// W1(t0) z of the tick's beginning and end. z of the stages is z0, twice the mean, z1.
template <int L, typename Scalar>
struct FirstLayer {
  const HiddenVector<L, Scalar>& at_begin;
  HiddenVector<L, Scalar> at_end;

  // factor W1(t0) z of a stage.
  template <int Stage>
  [[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> at(int row, Scalar factor) const {
    if constexpr (Stage == 0) return factor * load(&at_begin[row]);
    if constexpr (Stage == kStages - 1) return factor * load(&at_end[row]);
    return (Scalar(0.5) * factor) * (load(&at_begin[row]) + load(&at_end[row]));
  }
};

// What psi_hat of a stage is made of.
template <int N, typename Scalar>
struct SigmaSums {
  std::array<Scalar, kStages> before{};  // sigma_j . sigma_s, j < s
  Vector<N, Scalar> w2_sigma;            // W2(t0) sigma_s
};

// What the norm of theta is followed with.
template <typename Scalar>
struct GradientSums {
  Scalar sigma_squared{};  // |sigma_s|^2
  Scalar b_squared{};      // |b_s|^2
  Scalar with_theta{};     // b_s . (W1 z_s)
  Scalar with_begin{};     // b_s . (W1(t0) z_s)
};

// sigma of W1 z = keep W1(t0) z + sum kappa_j b_j at a stage but the first, into factors.
template <int Stage, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE SigmaSums<N, Scalar> sigma_pass(
    const FirstLayer<L, Scalar>& w1_z, const NetworkWeights<N, L, Scalar>& weights, Scalar keep,
    std::array<Scalar, kStages> kappa, StageFactors<L, Scalar>& factors) {
  static_assert(Stage > 0);
  constexpr auto kStage = static_cast<std::size_t>(Stage);
  using Lanes = Block<Scalar>;
  std::array<Lanes, kStage> before;
  std::array<Lanes, static_cast<std::size_t>(kMostJoints<N>)> w2_sigma;
  const Eigen::Index joints = weights.w2_transposed.cols();
  before.fill(spread(Scalar(0)));
  w2_sigma.fill(spread(Scalar(0)));
  for_each_block<Scalar, L, Stage == kStages - 1 ? kLongRow : kShortRow>([&](
      int row) __attribute__((always_inline)) {
    Lanes at = w1_z.template at<Stage>(row, keep);
    repeat<Stage>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      at += kappa[stage] * load(&factors.b[stage][row]);
    });
    const Lanes sigma = sigmoid_of_block<Scalar>(at);
    store<Scalar>(sigma, &factors.sigma_later[kStage - 1][row]);
    repeat<Stage>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      before[stage] += sigma * load(&factors.sigma(stage)[row]);
    });
    repeat<N>(
        joints, [&](int k) __attribute__((always_inline)) {
          w2_sigma[static_cast<std::size_t>(k)] += sigma * load(&weights.w2_transposed(row, k));
        });
  });
  SigmaSums<N, Scalar> sums;
  sums.w2_sigma.resize(joints);
  repeat<Stage>([&](int j) __attribute__((always_inline)) {
    const auto stage = static_cast<std::size_t>(j);
    sums.before[stage] = total<Scalar>(before[stage]);
  });
  repeat<N>(
      joints, [&](int k) __attribute__((always_inline)) {
        sums.w2_sigma[k] = total<Scalar>(w2_sigma[static_cast<std::size_t>(k)]);
      });
  return sums;
}

// factors.b[Stage] = (1 - sigma^2) / 2 (W2^T D) with W2^T D / 2 = W2(t0)^T kept_d + sum nu_j
// sigma_j. keep and kappa as in sigma_pass().
template <int Stage, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE GradientSums<Scalar> gradient_pass(
    const FirstLayer<L, Scalar>& w1_z, const NetworkWeights<N, L, Scalar>& weights,
    Vector<N, Scalar> kept_d, std::array<Scalar, kStages> nu, Scalar keep,
    std::array<Scalar, kStages> kappa, StageFactors<L, Scalar>& factors) {
  constexpr auto kStage = static_cast<std::size_t>(Stage);
  using Lanes = Block<Scalar>;
  Lanes sigma_squared = spread(Scalar(0));
  Lanes b_squared = spread(Scalar(0));
  Lanes with_begin = spread(Scalar(0));
  std::array<Lanes, kStages> with_b;
  with_b.fill(spread(Scalar(0)));
  for_each_block<Scalar, L>([&](int row) __attribute__((always_inline)) {
    Lanes back = kept_d[0] * load(&weights.w2_transposed(row, 0));
    repeat<N - 1>(
        kept_d.size() - 1, [&](int k) __attribute__((always_inline)) {
          back += kept_d[k + 1] * load(&weights.w2_transposed(row, k + 1));
        });
    repeat<Stage>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      back += nu[stage] * load(&factors.sigma(stage)[row]);
    });
    const Lanes sigma = load(&factors.sigma(kStage)[row]);
    const Lanes squared = sigma * sigma;
    const Lanes b = back - back * squared;
    store<Scalar>(b, &factors.b[kStage][row]);
    sigma_squared += squared;
    b_squared += b * b;
    with_begin += b * w1_z.template at<Stage>(row, Scalar(1));
    repeat<Stage>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      with_b[stage] += b * load(&factors.b[stage][row]);
    });
  });
  GradientSums<Scalar> sums;
  sums.sigma_squared = total<Scalar>(sigma_squared);
  sums.b_squared = total<Scalar>(b_squared);
  sums.with_begin = total<Scalar>(with_begin);
  sums.with_theta = keep * sums.with_begin;
  repeat<Stage>([&](int j) __attribute__((always_inline)) {
    const auto stage = static_cast<std::size_t>(j);
    sums.with_theta += kappa[stage] * total<Scalar>(with_b[stage]);
  });
  return sums;
}

// theta <- keep theta + sum gain_j g_j and w1_z <- W1 z1 with it; returns the new |theta|^2. z_j is
// z0 at the first stage, z1 at the last and their mean at the two between, so that
// W1 <- keep W1 + p z0^T + r z1^T. share(k, j) = gain_j D_j[k].
template <int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Scalar
update_weights(SpanPoint<Scalar> point, Matrix<N, kStages, Scalar> share,
               const StageFactors<L, Scalar>& factors, const HiddenVector<L, Scalar>& w1_z1,
               const NetworkInput<N, Scalar>& z0, const NetworkInput<N, Scalar>& z1, Scalar z01,
               Scalar z11, NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& w1_z) {
  using Lanes = Block<Scalar>;
  constexpr auto kInputs = static_cast<std::size_t>(kMostNetworkInputs<N>);
  const Eigen::Index inputs = z0.size();
  const Eigen::Index joints = weights.w2_transposed.cols();
  // Spread over the lanes once, not once per block.
  std::array<Lanes, kInputs> at_begin;
  std::array<Lanes, kInputs> at_end;
  repeat<kNetworkInputs<N>>(
      inputs, [&](int i) __attribute__((always_inline)) {
        at_begin[static_cast<std::size_t>(i)] = spread(z0[i]);
        at_end[static_cast<std::size_t>(i)] = spread(z1[i]);
      });
  const Scalar half_1 = Scalar(0.5) * point.gain[1];
  const Scalar half_2 = Scalar(0.5) * point.gain[2];
  // With vectors one sum per column: a single one would be a chain of dependent additions.
  std::array<Lanes, kLanes<Scalar> == 1 ? 1 : kInputs> squares;
  squares.fill(spread(Scalar(0)));
  for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
    const Lanes middle = half_1 * load(&factors.b[1][row]) + half_2 * load(&factors.b[2][row]);
    const Lanes p = point.gain[0] * load(&factors.b[0][row]) + middle;
    const Lanes r = point.gain[3] * load(&factors.b[3][row]) + middle;
    store<Scalar>(point.keep * load(&w1_z1[row]) + z01 * p + z11 * r, &w1_z[row]);
    repeat<kNetworkInputs<N>>(
        inputs, [&](int input) __attribute__((always_inline)) {
          const auto i = static_cast<std::size_t>(input);
          Scalar* const w = &weights.w1(row, input);
          const Lanes updated = point.keep * load<Scalar>(w) + at_begin[i] * p + at_end[i] * r;
          squares[i % squares.size()] += updated * updated;
          store<Scalar>(updated, w);
        });
  });
  for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
    std::array<Lanes, kStages> sigma;
    repeat<kStages>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      sigma[stage] = load(&factors.sigma(stage)[row]);
    });
    repeat<N>(
        joints, [&](int k) __attribute__((always_inline)) {
          Scalar* const w = &weights.w2_transposed(row, k);
          Lanes updated = point.keep * load<Scalar>(w);
          repeat<kStages>([&](int j) __attribute__((always_inline)) {
            updated += share(k, j) * sigma[static_cast<std::size_t>(j)];
          });
          squares[static_cast<std::size_t>(k) % squares.size()] += updated * updated;
          store<Scalar>(updated, w);
        });
  });
  Lanes sum = spread(Scalar(0));
  for (const Lanes& part : squares) sum += part;
  return total<Scalar>(sum);
}

// theta <- shrink theta, likewise w1_z = W1 z; sigma of it, and psi_hat = W2 sigma.
template <int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<N, Scalar> shrink_and_look(
    Scalar shrink, NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& w1_z,
    HiddenVector<L, Scalar>& sigma) {
  using Lanes = Block<Scalar>;
  const Eigen::Index joints = weights.w2_transposed.cols();
  std::array<Lanes, static_cast<std::size_t>(kMostJoints<N>)> psi;
  psi.fill(spread(Scalar(0)));
  for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
    const Lanes pre = shrink * load<Scalar>(&w1_z[row]);
    const Lanes s = sigmoid_of_block<Scalar>(pre);
    store<Scalar>(pre, &w1_z[row]);
    store<Scalar>(s, &sigma[row]);
    repeat<kNetworkInputs<N>>(
        weights.w1.cols(), [&](int input) __attribute__((always_inline)) {
          Scalar* const w = &weights.w1(row, input);
          store<Scalar>(shrink * load<Scalar>(w), w);
        });
    repeat<N>(
        joints, [&](int k) __attribute__((always_inline)) {
          Scalar* const w = &weights.w2_transposed(row, k);
          const Lanes w2 = shrink * load<Scalar>(w);
          store<Scalar>(w2, w);
          psi[static_cast<std::size_t>(k)] += s * w2;
        });
  });
  Vector<N, Scalar> psi_hat;
  psi_hat.resize(joints);
  for (Eigen::Index k = 0; k < joints; ++k) {
    psi_hat[k] = total<Scalar>(psi[static_cast<std::size_t>(k)]);
  }
  return psi_hat;
}

}  // namespace offnominal::detail
