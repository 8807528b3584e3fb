#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <offnominal/joint_count.hpp>

namespace offnominal {

static_assert(kRuntimeJoints == Eigen::Dynamic);

// Rows and Columns: numbers, or kRuntimeJoints for one of run time, which is 0 at first.
template <int Rows, typename Scalar>
using Vector = Eigen::Matrix<Scalar, Rows, 1, Eigen::AutoAlign, kMostJoints<Rows>, 1>;
template <int Rows, int Columns, typename Scalar>
using Matrix = Eigen::Matrix<Scalar, Rows, Columns,
                             Eigen::AutoAlign | (Rows == 1 && Columns != 1 ? Eigen::RowMajor
                                                 : Columns == 1 && Rows != 1
                                                     ? Eigen::ColMajor  // NOLINT
                                                     : EIGEN_DEFAULT_MATRIX_STORAGE_ORDER_OPTION),
                             kMostJoints<Rows>, kMostJoints<Columns>>;

// One 0, or 1, per joint; `joints` counts where the compiler does not know it.
template <int N, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<N, Scalar> zeros(Eigen::Index joints = 0) {
  if constexpr (N == kRuntimeJoints) {
    return Vector<N, Scalar>::Zero(joints);
  } else {
    return Vector<N, Scalar>::Zero();
  }
}
template <int N, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Vector<N, Scalar> ones(Eigen::Index joints = 0) {
  if constexpr (N == kRuntimeJoints) {
    return Vector<N, Scalar>::Ones(joints);
  } else {
    return Vector<N, Scalar>::Ones();
  }
}
// Zeros where the compiler knows how many, none where it does not.
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE Values no_values() {
  if constexpr (Values::SizeAtCompileTime == Eigen::Dynamic) {
    return Values();
  } else {
    return Values::Zero();
  }
}

namespace detail {

template <typename Values>
EIGEN_ALWAYS_INLINE void size_one_for(std::size_t joints, Values& values) {
  if constexpr (requires { values.assign(joints, values[0]); }) {
    values.assign(joints, {});
  } else if constexpr (requires { Values::RowsAtCompileTime; }) {
    if constexpr (Values::RowsAtCompileTime == Eigen::Dynamic) {
      values.setZero(static_cast<Eigen::Index>(joints));
    }
  }
}

// The sum of the products of `size` numbers, in the order in which Eigen forms it for as many that
// the compiler knows: of First, First + Step, .., Most.
template <int First, int Step, int Most, typename Scalar>
[[nodiscard]] Scalar dot_of_size(const Scalar* a, const Scalar* b, Eigen::Index size) {
  if constexpr (First < Most) {
    if (size != First) return dot_of_size<First + Step, Step, Most>(a, b, size);
  }
  using Fixed = Eigen::Map<const Eigen::Matrix<Scalar, First, 1>>;
  return Fixed(a).dot(Fixed(b));
}

// a . b, |a|^2 and |a| with the same bits whether the compiler knows the size or not: one of run
// time is First, First + Step, ...
template <int First = 1, int Step = 1, typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE typename Values::Scalar dot(const Values& a, const Values& b) {
  if constexpr (Values::SizeAtCompileTime == Eigen::Dynamic) {
    return dot_of_size<First, Step, Values::MaxSizeAtCompileTime>(a.data(), b.data(), a.size());
  } else {
    return a.dot(b);
  }
}
template <int First = 1, int Step = 1, typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE typename Values::Scalar squared_length(const Values& a) {
  if constexpr (Values::SizeAtCompileTime == Eigen::Dynamic) {
    return dot<First, Step>(a, a);
  } else {
    return a.squaredNorm();
  }
}
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE typename Values::Scalar length(const Values& a) {
  if constexpr (Values::SizeAtCompileTime == Eigen::Dynamic) {
    return Eigen::numext::sqrt(squared_length(a));
  } else {
    return a.norm();
  }
}

}  // namespace detail

// Makes zeros, one per joint, of those whose size is not known to the compiler: vectors and
// PerJoint. The others stay what they are.
template <typename... Values>
EIGEN_ALWAYS_INLINE void size_for(std::size_t joints, Values&... values) {
  (detail::size_one_for(joints, values), ...);
}

}  // namespace offnominal
