#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <offnominal/diagnosis/gradient_span.hpp>
#include <offnominal/diagnosis/lanes.hpp>
#include <offnominal/diagnosis/network.hpp>

// The work on the hidden layer inside one tick: one sweep over the hidden units per Runge-Kutta
// stage, in blocks of the processor's vector length, with all inner products of the stage summed on
// the way. Scalars of a stage come by value, so that no store to the vectors can make the compiler
// load them again.

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
  // Twice that of the mean. Lies where the last stage's sigma comes, which reads at_end alone.
  HiddenVector<L, Scalar>& twice_middle;

  // W1(t0) z of a stage is so many times what is loaded for it.
  template <int Stage>
  static constexpr Scalar kFactor = Stage == 0 || Stage == kStages - 1 ? Scalar(1) : Scalar(0.5);
  template <int Stage>
  [[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> load_at(int row) const {
    if constexpr (Stage == 0) return load(&at_begin[row]);
    if constexpr (Stage == kStages - 1) return load(&at_end[row]);
    return load(&twice_middle[row]);
  }
};

// W1(t0) z1, where the tick ends.
template <int N, int L, typename Scalar>
EIGEN_ALWAYS_INLINE void look_at_end(const NetworkWeights<N, L, Scalar>& weights,
                                     const NetworkInput<N, Scalar>& z1,
                                     FirstLayer<L, Scalar>& w1_z) {
  first_layer<N, L, Scalar>(
      weights, z1, [&](int row, const Block<Scalar>& sum) __attribute__((always_inline)) {
        store<Scalar>(sum, &w1_z.at_end[row]);
        store<Scalar>(load(&w1_z.at_begin[row]) + sum, &w1_z.twice_middle[row]);
      });
}

// What psi_hat of a stage is made of.
template <int N, typename Scalar>
struct SigmaSums {
  std::array<Scalar, kStages> before{};  // sigma_j . sigma_s, j < s
  Vector<N, Scalar> w2_sigma;            // W2(t0) sigma_s
};

// What the norm of theta is followed with.
template <typename Scalar>
struct GradientSums {
  Scalar sigma_squared{};                // |sigma_s|^2
  Scalar b_squared{};                    // |b_s|^2
  Scalar with_begin{};                   // b_s . (W1(t0) z_s)
  std::array<Scalar, kStages> with_b{};  // b_s . b_j, j < s
};

// sigma of W1 z = keep W1(t0) z + sum kappa_j b_j at a stage but the first, into factors.
template <int Stage, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE SigmaSums<N, Scalar> sigma_pass(
    const FirstLayer<L, Scalar>& w1_z, const NetworkWeights<N, L, Scalar>& weights, Scalar keep,
    std::array<Scalar, kStages> kappa, StageFactors<L, Scalar>& factors) {
  static_assert(Stage > 0);
  const Scalar keep_loaded = FirstLayer<L, Scalar>::template kFactor<Stage> * keep;
  constexpr auto kStage = static_cast<std::size_t>(Stage);
  using Lanes = Block<Scalar>;
  std::array<Lanes, kStage> before;
  std::array<Lanes, static_cast<std::size_t>(kMostJoints<N>)> w2_sigma;
  const Eigen::Index joints = weights.w2_transposed.cols();
  before.fill(spread(Scalar(0)));
  w2_sigma.fill(spread(Scalar(0)));
  for_each_block<Scalar, L, kMediumRow>([&](int row) __attribute__((always_inline)) {
    Lanes at = keep_loaded * w1_z.template load_at<Stage>(row);
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
// sigma_j.
template <int Stage, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE GradientSums<Scalar> gradient_pass(
    const FirstLayer<L, Scalar>& w1_z, const NetworkWeights<N, L, Scalar>& weights,
    Vector<N, Scalar> kept_d, std::array<Scalar, kStages> nu, StageFactors<L, Scalar>& factors) {
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
    with_begin += b * w1_z.template load_at<Stage>(row);
    repeat<Stage>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      with_b[stage] += b * load(&factors.b[stage][row]);
    });
  });
  GradientSums<Scalar> sums;
  sums.sigma_squared = total<Scalar>(sigma_squared);
  sums.b_squared = total<Scalar>(b_squared);
  sums.with_begin = FirstLayer<L, Scalar>::template kFactor<Stage> * total<Scalar>(with_begin);
  repeat<Stage>([&](int j) __attribute__((always_inline)) {
    const auto stage = static_cast<std::size_t>(j);
    sums.with_b[stage] = total<Scalar>(with_b[stage]);
  });
  return sums;
}

// What a move of theta leaves: |theta|^2, and psi_hat where the tick ends.
template <int N, typename Scalar>
struct MovedWeights {
  Scalar squared_norm{};
  Vector<N, Scalar> psi_hat;
};

// Of theta <- keep theta + sum gain_j g_j the hidden layer alone: w1_z <- W1 z1 and its sigma. z_j
// is z0 at the first stage, z1 at the last and their mean at the two between, so that
// W1 <- keep W1 + p z0^T + r z1^T. p, r and sigma take the places of b_0, b_3 and b_1.
template <int L, typename Scalar>
EIGEN_ALWAYS_INLINE void move_hidden_layer(SpanPoint<Scalar> point,
                                           const HiddenVector<L, Scalar>& w1_z1, Scalar z01,
                                           Scalar z11, StageFactors<L, Scalar>& factors,
                                           HiddenVector<L, Scalar>& w1_z) {
  using Lanes = Block<Scalar>;
  const Scalar half_1 = Scalar(0.5) * point.gain[1];
  const Scalar half_2 = Scalar(0.5) * point.gain[2];
  for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
    const Lanes middle = half_1 * load(&factors.b[1][row]) + half_2 * load(&factors.b[2][row]);
    const Lanes p = point.gain[0] * load(&factors.b[0][row]) + middle;
    const Lanes r = point.gain[3] * load(&factors.b[3][row]) + middle;
    const Lanes pre = point.keep * load(&w1_z1[row]) + z01 * p + z11 * r;
    store<Scalar>(p, &factors.b[0][row]);
    store<Scalar>(r, &factors.b[3][row]);
    store<Scalar>(pre, &w1_z[row]);
    store<Scalar>(sigmoid_of_block<Scalar>(pre), &factors.b[1][row]);
  });
}

// The same move of W1, behind move_hidden_layer(). Returns |W1|^2, lane by lane.
template <int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> move_input_weights(
    Scalar keep, const StageFactors<L, Scalar>& factors, const NetworkInput<N, Scalar>& z0,
    const NetworkInput<N, Scalar>& z1, NetworkWeights<N, L, Scalar>& weights) {
  using Lanes = Block<Scalar>;
  constexpr int kWidth = kLanes<Scalar>;
  const Eigen::Index inputs = z0.size();
  if constexpr (kWidth == 1) {
    // Many rows at once: what a turn loads and counts is shared by all of them.
    Scalar squares(0);
    for_each_turn<L>([&]<int Rows>(int row) __attribute__((always_inline)) {
      std::array<Scalar, static_cast<std::size_t>(Rows)> p;
      std::array<Scalar, static_cast<std::size_t>(Rows)> r;
      repeat<Rows>([&](int i) __attribute__((always_inline)) {
        p[static_cast<std::size_t>(i)] = factors.b[0][row + i];
        r[static_cast<std::size_t>(i)] = factors.b[3][row + i];
      });
      for (Eigen::Index input = 0; input < inputs; ++input) {
        const Scalar at_begin = z0[input];
        const Scalar at_end = z1[input];
        Scalar* const w = &weights.w1(row, input);
        repeat<Rows>([&](int i) __attribute__((always_inline)) {
          const Scalar updated = keep * w[i] + at_begin * p[static_cast<std::size_t>(i)] +
                                 at_end * r[static_cast<std::size_t>(i)];
          squares += updated * updated;
          w[i] = updated;
        });
      }
    });
    return squares;
  } else {
    constexpr auto kInputs = static_cast<std::size_t>(kMostNetworkInputs<N>);
    // Spread over the lanes once, not once per block.
    std::array<Lanes, kInputs> at_begin;
    std::array<Lanes, kInputs> at_end;
    repeat<kNetworkInputs<N>>(
        inputs, [&](int i) __attribute__((always_inline)) {
          at_begin[static_cast<std::size_t>(i)] = spread(z0[i]);
          at_end[static_cast<std::size_t>(i)] = spread(z1[i]);
        });
    // One sum per column: a single one would be a chain of dependent additions.
    std::array<Lanes, kInputs> squares;
    squares.fill(spread(Scalar(0)));
    for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
      const Lanes p = load(&factors.b[0][row]);
      const Lanes r = load(&factors.b[3][row]);
      repeat<kNetworkInputs<N>>(
          inputs, [&](int input) __attribute__((always_inline)) {
            const auto i = static_cast<std::size_t>(input);
            Scalar* const w = &weights.w1(row, input);
            const Lanes updated = keep * load<Scalar>(w) + at_begin[i] * p + at_end[i] * r;
            squares[i] += updated * updated;
            store<Scalar>(updated, w);
          });
    });
    Lanes sum = spread(Scalar(0));
    for (const Lanes& part : squares) sum += part;
    return sum;
  }
}

// The same move of W2's columns First .. First + Columns - 1 (of all, where their number is none),
// behind move_hidden_layer(), and psi_hat of them. share(k, j) = gain_j D_j[k]. The last columns
// take sigma along. Returns their |W2|^2, lane by lane.
template <int First, int Columns, bool Last, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> move_columns(
    Scalar keep, const Matrix<N, kStages, Scalar>& share, const StageFactors<L, Scalar>& factors,
    NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& sigma_end,
    Vector<N, Scalar>& psi_hat) {
  using Lanes = Block<Scalar>;
  constexpr auto kMost = static_cast<std::size_t>(kMostJoints<Columns>);
  const Eigen::Index columns = weights.w2_transposed.cols();
  std::array<Lanes, kMost> psi;
  std::array<Lanes, kLanes<Scalar> == 1 ? 1 : kMost> squares;
  psi.fill(spread(Scalar(0)));
  squares.fill(spread(Scalar(0)));
  for_each_block<Scalar, L, kLongRow>([&](int row) __attribute__((always_inline)) {
    std::array<Lanes, kStages> sigma;
    repeat<kStages>([&](int j) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(j);
      sigma[stage] = load(&factors.sigma(stage)[row]);
    });
    const Lanes at_end = load(&factors.b[1][row]);
    repeat<Columns>(
        columns, [&](int k) __attribute__((always_inline)) {
          Scalar* const w = &weights.w2_transposed(row, First + k);
          Lanes updated = keep * load<Scalar>(w);
          repeat<kStages>([&](int j) __attribute__((always_inline)) {
            updated += share(First + k, j) * sigma[static_cast<std::size_t>(j)];
          });
          squares[static_cast<std::size_t>(k) % squares.size()] += updated * updated;
          psi[static_cast<std::size_t>(k)] += at_end * updated;
          store<Scalar>(updated, w);
        });
    if constexpr (Last) store<Scalar>(at_end, &sigma_end[row]);
  });
  repeat<Columns>(
      columns, [&](int k) __attribute__((always_inline)) {
        psi_hat[First + k] = total<Scalar>(psi[static_cast<std::size_t>(k)]);
      });
  Lanes sum = spread(Scalar(0));
  for (const Lanes& part : squares) sum += part;
  return sum;
}

// So many columns of W2 at once that all that belongs to them stays in registers. Where the
// processor has no vectors, |W2|^2 of five joints and more is summed in another order than of a
// number of joints that is known at run time.
template <int First, int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> move_output_weights(
    Scalar keep, const Matrix<N, kStages, Scalar>& share, const StageFactors<L, Scalar>& factors,
    NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& sigma,
    Vector<N, Scalar>& psi_hat) {
  constexpr int kMostColumns = 4;
  constexpr int kLeft = N - First;
  if constexpr (N == kRuntimeJoints || kLanes<Scalar> != 1 || kLeft <= kMostColumns) {
    constexpr int kColumns = N == kRuntimeJoints ? N : kLeft;
    return move_columns<First, kColumns, true>(keep, share, factors, weights, sigma, psi_hat);
  } else {
    const Block<Scalar> squares =
        move_columns<First, kMostColumns, false>(keep, share, factors, weights, sigma, psi_hat);
    return squares +
           move_output_weights<First + kMostColumns>(keep, share, factors, weights, sigma, psi_hat);
  }
}

// theta <- keep theta + sum gain_j g_j, w1_z <- W1 z1 with it, and sigma of that.
template <int N, int L, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE MovedWeights<N, Scalar> move_weights(
    const SpanPoint<Scalar>& point, const Matrix<N, kStages, Scalar>& share,
    const HiddenVector<L, Scalar>& w1_z1, const NetworkInput<N, Scalar>& z0,
    const NetworkInput<N, Scalar>& z1, Scalar z01, Scalar z11, StageFactors<L, Scalar>& factors,
    NetworkWeights<N, L, Scalar>& weights, HiddenVector<L, Scalar>& w1_z,
    HiddenVector<L, Scalar>& sigma) {
  MovedWeights<N, Scalar> moved;
  moved.psi_hat.resize(weights.w2_transposed.cols());
  move_hidden_layer<L, Scalar>(point, w1_z1, z01, z11, factors, w1_z);
  const Block<Scalar> of_inputs =
      move_input_weights<N, L, Scalar>(point.keep, factors, z0, z1, weights);
  const Block<Scalar> of_outputs = move_output_weights<0, N, L, Scalar>(
      point.keep, share, factors, weights, sigma, moved.psi_hat);
  moved.squared_norm = total<Scalar>(of_inputs + of_outputs);
  return moved;
}

}  // namespace offnominal::detail
