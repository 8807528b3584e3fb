#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <offnominal/diagnosis/lanes.hpp>
#include <offnominal/exponential.hpp>

namespace offnominal {

namespace detail {

// Whether the larger of two numbers is one instruction. The FPUs of Cortex-M have it where they are
// of version 5, which no macro says: all that know double precision are, and all of Armv8-M.
#if defined(__ARM_FEATURE_NUMERIC_MAXMIN) ||                                          \
    (defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M' && defined(__ARM_FP) && \
     ((__ARM_FP & 8) != 0 || __ARM_ARCH >= 8))
#define OFFNOMINAL_HAS_MAXMIN
#endif

// x held to [-16, 16] without a branch; NaN gives 16.
[[nodiscard]] EIGEN_ALWAYS_INLINE float held_to_16(float x) {
#ifdef OFFNOMINAL_HAS_MAXMIN
  return std::fmax(-16.0F, std::fmin(16.0F, x));
#else
  // A comparison of numbers may become a jump, one of whole numbers becomes a choice.
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const std::uint32_t magnitude = std::min(bits & 0x7FFFFFFFU, std::bit_cast<std::uint32_t>(16.0F));
  return std::bit_cast<float>((bits & 0x80000000U) | magnitude);
#endif
}

// The same on vectors.
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE Values held_to_16(const Values& x) {
  const Values most = 16.0F - Values{};
  const Values low = x < most ? x : most;
  return low > -most ? low : -most;
}

// sigma(x) from e^x with one division. Values: double, or a vector of them.
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE Values sigmoid_of(const Values& x) {
  const ExponentialParts<Values> e = exponential_parts(x);
  return (e.up - e.down) / (e.up + e.down);
}

// sigma of arguments inside [-16, 16]. Values: float, or a vector of them.
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE Values sigmoid_within_16(const Values& x) {
  const Values square = x * x;
  const Values p = x * (2.49999824e-1F + square * (1.68785795e-3F + square * 8.60170057e-7F));
  const Values q = 1.0F + square * (2.75843057e-2F + square * 5.73465012e-5F);
  return (p + p) * q / (p * p + q * q);
}

}  // namespace detail

// sigma(x) = tanh(x / 2), the paper's sigmoid with its sign mirrored (the output weights absorb the
// sign); its derivative is (1 - sigma^2) / 2. Element by element; the same work for every argument,
// no branches.
//
// float: tanh(x / 4) = P / Q, P of degree 5 and Q of degree 4 fitted for the smallest largest error
// of sigma on [-16, 16], and the double-angle formula 2 P Q / (P^2 + Q^2), which cannot leave
// [-1, 1]. Absolute error below 4e-7. NaN gives a number in [-1, 1].
// double: from one exponential, absolute error below 1e-15. NaN gives NaN.
[[nodiscard]] EIGEN_ALWAYS_INLINE float sigmoid(float x) {
  return detail::sigmoid_within_16(detail::held_to_16(x));
}
[[nodiscard]] EIGEN_ALWAYS_INLINE double sigmoid(double x) { return detail::sigmoid_of(x); }

namespace detail {

// sigma of every element of a block that is a vector.
template <typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Block<Scalar> sigmoid_of_block(const Block<Scalar>& x) {
  if constexpr (kLanes<Scalar> == 1) {
    return sigmoid(x);
  } else if constexpr (std::same_as<Scalar, float>) {
    return sigmoid_within_16<Block<float>>(held_to_16<Block<float>>(x));
  } else {
    return sigmoid_of<Block<double>>(x);
  }
}

}  // namespace detail

template <int Rows, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Eigen::Array<Scalar, Rows, 1> sigmoid(
    const Eigen::Array<Scalar, Rows, 1>& x) {
  Eigen::Array<Scalar, Rows, 1> y;
  if constexpr (Rows % kLanes<Scalar> == 0) {
    detail::for_each_block<Scalar, Rows, detail::kLongRow>([&](
        int row) __attribute__((always_inline)) {
      detail::store<Scalar>(detail::sigmoid_of_block<Scalar>(detail::load(&x[row])), &y[row]);
    });
  } else {
    for (Eigen::Index i = 0; i < Rows; ++i) y[i] = sigmoid(x[i]);
  }
  return y;
}

}  // namespace offnominal
