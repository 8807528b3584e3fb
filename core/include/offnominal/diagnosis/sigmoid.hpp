#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <offnominal/exponential.hpp>

namespace offnominal {

namespace detail {

// x held to [-16, 16] without a branch; NaN gives 16.
[[nodiscard]] EIGEN_ALWAYS_INLINE float held_to_16(float x) {
#ifdef __ARM_FEATURE_NUMERIC_MAXMIN
  return std::fmax(-16.0F, std::fmin(16.0F, x));
#else
  // A comparison of numbers may become a jump, one of whole numbers becomes a choice.
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const std::uint32_t magnitude = std::min(bits & 0x7FFFFFFFU, std::bit_cast<std::uint32_t>(16.0F));
  return std::bit_cast<float>((bits & 0x80000000U) | magnitude);
#endif
}

// sigma(x) from e^x with one division.
[[nodiscard]] EIGEN_ALWAYS_INLINE double sigmoid_of(double x) {
  const ExponentialParts e = exponential_parts(x);
  return (e.up - e.down) / (e.up + e.down);
}

// sigma of arguments inside [-16, 16]: numbers or arrays.
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

template <int Rows, typename Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE Eigen::Array<Scalar, Rows, 1> sigmoid(
    const Eigen::Array<Scalar, Rows, 1>& x) {
  using Block = Eigen::Array<Scalar, Rows, 1>;
  if constexpr (Eigen::internal::packet_traits<Scalar>::size == 1 || Rows == 1) {
    Block y;
    for (Eigen::Index i = 0; i < Rows; ++i) y[i] = sigmoid(x[i]);
    return y;
  } else if constexpr (std::same_as<Scalar, float>) {
    return detail::sigmoid_within_16<Block>(
        Block::Constant(-16.0F).max(Block::Constant(16.0F).min(x)));
  } else {
    // An exponential that overflows to infinity gives the right limit, 1.
    return Scalar(1) - Scalar(2) / (x.exp() + Scalar(1));
  }
}

}  // namespace offnominal
