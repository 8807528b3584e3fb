#pragma once

#include <Eigen/Core>
#include <cmath>
#include <offnominal/finite.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/repeat.hpp>

// Products and solutions of as many equations as there are joints. Every sum is formed in one
// order: Eigen's begin where the memory is aligned, so that their last bits follow the address.
// Sums are written out, as a loop on a controller costs more than its work.

namespace offnominal {

// a x for a square matrix or map.
template <int N, typename Scalar, typename Square>
[[nodiscard]] Vector<N, Scalar> product(const Square& a, const Vector<N, Scalar>& x) {
  Vector<N, Scalar> result;
  result.resize(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    Scalar sum = a(i, 0) * x[0];
    detail::repeat<N - 1>(
        x.size() - 1, [&](int k) __attribute__((always_inline)) { sum += a(i, k + 1) * x[k + 1]; });
    result[i] = sum;
  }
  return result;
}

// The lower factor of m = factor factor^T; reads m's lower part. False, and `factor` unusable,
// where m is not positive definite to rounding, or not finite.
template <int N, typename Scalar>
[[nodiscard]] bool cholesky(const Matrix<N, N, Scalar>& m, Matrix<N, N, Scalar>& factor) {
  const Eigen::Index n = m.rows();
  factor.setZero(n, n);
  bool good = true;
  detail::repeat<N>(
      n, [&](int j) __attribute__((always_inline)) {
        Scalar pivot = m(j, j);
        detail::repeat<N>(
            n, [&](int k) __attribute__((always_inline)) {
              if (k < j) pivot -= factor(j, k) * factor(j, k);
            });
        good = good && is_finite(pivot) && pivot > 0;
        const Scalar root = std::sqrt(pivot);
        const Scalar inverse = Scalar(1) / root;
        factor(j, j) = root;
        for (Eigen::Index i = j + 1; i < n; ++i) {
          Scalar sum = m(i, j);
          detail::repeat<N>(
              n, [&](int k) __attribute__((always_inline)) {
                if (k < j) sum -= factor(i, k) * factor(j, k);
              });
          factor(i, j) = sum * inverse;
        }
      });
  return good;
}

// x = (factor factor^T)^-1 x
template <int N, typename Scalar>
void solve_in_place(const Matrix<N, N, Scalar>& factor, Vector<N, Scalar>& x) {
  const Eigen::Index n = x.size();
  detail::repeat<N>(
      n, [&](int i) __attribute__((always_inline)) {
        Scalar sum = x[i];
        detail::repeat<N>(
            n, [&](int k) __attribute__((always_inline)) {
              if (k < i) sum -= factor(i, k) * x[k];
            });
        x[i] = sum / factor(i, i);
      });
  detail::repeat<N>(
      n, [&](int back) __attribute__((always_inline)) {
        const Eigen::Index i = n - 1 - back;
        Scalar sum = x[i];
        detail::repeat<N>(
            n, [&](int k) __attribute__((always_inline)) {
              if (k > i) sum -= factor(k, i) * x[k];
            });
        x[i] = sum / factor(i, i);
      });
}

}  // namespace offnominal
