#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <offnominal/repeat.hpp>

// The weights inside one tick, without vectors of the length of theta.
//
// The learning law is theta' = Gamma (g - pull theta) with the gradient g = Z^T D[e] and the pull
// of projection, both of them different at each of the four Runge-Kutta stages. Every stage's theta
// is therefore
//   theta = keep theta_0 + sum over the stages before of gain_j g_j
// with scalars keep and gain_j: exact, not an approximation. g_j is the pair of rank-one matrices
// (b_j z_j^T, D_j sigma_j^T). A stage's theta starts from theta_0 and moves along one derivative
// only, so that its norm follows from inner products with g of that one stage.

namespace offnominal::detail {

inline constexpr int kStages = 4;

// Coordinates in span{theta_0, g_0, .., g_3} and what projection has to know of a point in it.
template <typename Scalar>
struct SpanPoint {
  Scalar keep{};
  std::array<Scalar, kStages> gain{};
};

template <typename Scalar>
struct SpanNorms {
  Scalar squared{};     // |theta|^2
  Scalar with_begin{};  // <theta_0, theta>
};

// Inner products of one stage's gradient g, at that stage's theta.
template <typename Scalar>
struct GradientProducts {
  Scalar with_begin{};  // <theta_0, g> = b . (W1(t0) z) + D . (W2(t0) sigma)
  Scalar with_theta{};  // <theta, g>   = b . (W1 z) + D . psi_hat
  Scalar squared{};     // |g|^2        = |b|^2 |z|^2 + |D|^2 |sigma|^2
};

// Those of every stage, and of one stage's gradient with another's.
template <typename Scalar>
struct SpanProducts {
  std::array<GradientProducts<Scalar>, kStages> of_stage;
  std::array<std::array<Scalar, kStages>, kStages> pairs;  // <g_i, g_j>, j < i

  // |keep theta_0 + sum gain_j g_j|^2. What rounding makes of it goes with the squares of the
  // parts, of which it may be the small rest.
  [[nodiscard]] EIGEN_ALWAYS_INLINE Scalar squared_norm(const SpanPoint<Scalar>& at,
                                                        Scalar begin_squared) const {
    Scalar sum = at.keep * at.keep * begin_squared;
    repeat<kStages>([&](int i) __attribute__((always_inline)) {
      const auto stage = static_cast<std::size_t>(i);
      Scalar along = at.keep * of_stage[stage].with_begin;
      repeat<kStages>([&](int j) __attribute__((always_inline)) {
        const auto before = static_cast<std::size_t>(j);
        if (j < i) along += at.gain[before] * pairs[stage][before];
      });
      sum += at.gain[stage] * (along + along + at.gain[stage] * of_stage[stage].squared);
    });
    return sum;
  }
};

// theta_0 + step (g_Stage - pull theta), from stage `Stage` with coordinates `at`.
template <int Stage, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE SpanPoint<Scalar> moved(const SpanPoint<Scalar>& at, Scalar step,
                                                          Scalar pull) {
  SpanPoint<Scalar> next;
  next.keep = Scalar(1) - step * pull * at.keep;
  repeat<Stage>([&](int j) __attribute__((always_inline)) {
    const auto stage = static_cast<std::size_t>(j);
    next.gain[stage] = -(step * pull) * at.gain[stage];
  });
  next.gain[Stage] = step;
  return next;
}

// The norms of the same point.
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE SpanNorms<Scalar> moved(const SpanNorms<Scalar>& at,
                                                          const GradientProducts<Scalar>& g,
                                                          Scalar begin_squared, Scalar step,
                                                          Scalar pull) {
  const Scalar along_begin = step * (g.with_begin - pull * at.with_begin);
  const Scalar moved_squared = g.squared - pull * (g.with_theta + g.with_theta - pull * at.squared);
  return {begin_squared + along_begin + along_begin + step * step * moved_squared,
          begin_squared + along_begin};
}

// What rounding can make of a sum of L-element inner products whose terms add up to `magnitude`.
template <int L, typename Scalar>
[[nodiscard]] constexpr Scalar rounding_allowance(Scalar magnitude) {
  return Scalar(2 * L + 64) * std::numeric_limits<Scalar>::epsilon() * magnitude;
}

}  // namespace offnominal::detail
