#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <offnominal/finite.hpp>

namespace offnominal {

namespace detail {

// e^x = up / down, both positive. Values: double, or a vector of them.
template <typename Values>
struct ExponentialParts {
  Values up;
  Values down;
};

// Whole numbers of the same size, as many.
template <typename Values>
struct BitsOf {
  using Type [[gnu::vector_size(sizeof(Values))]] = std::uint64_t;
};
template <>
struct BitsOf<double> {
  using Type = std::uint64_t;
};

// x held to [-most, most] without a call; NaN stays.
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE Values held(const Values& x, const Values& most) {
  const Values low = x < -most ? -most : x;
  return low > most ? most : low;
}

// 2^n (Q + P) / (Q - P) with the rational of Cephes (S. L. Moshier) on [-ln(2)/2, ln(2)/2].
template <typename Values>
[[nodiscard]] EIGEN_ALWAYS_INLINE ExponentialParts<Values> exponential_parts(const Values& x) {
  OFFNOMINAL_SUMS_IN_ORDER
  using Bits = typename BitsOf<Values>::Type;
  const Values at = held<Values>(x, 708.0 - Values{});
  // 1.5 * 2^52: what is added to it is rounded to a whole number, which is then its last bits.
  constexpr double kRounding = 6755399441055744.0;
  const Values shifted = at * 1.4426950408889634 + kRounding;
  const Values n = shifted - kRounding;
  const Values r = (at - n * 0.693145751953125) - n * 1.42860682030941723212e-6;
  const Values s = r * r;
  const Values p = r * (9.99999999999999999910e-1 +
                        s * (3.02994407707441961300e-2 + s * 1.26177193074810590878e-4));
  const Values q = 2.0 + s * (2.27265548208155028766e-1 +
                              s * (2.52448340349684104192e-3 + s * 3.00198505138664455042e-6));
  const Bits exponent = (std::bit_cast<Bits>(shifted) + std::uint64_t{1023}) & std::uint64_t{0x7FF};
  return {std::bit_cast<Values>(exponent << std::uint64_t{52}) * (q + p), q - p};
}

}  // namespace detail

// e^x: the same work for every argument, no branches and no call. Relative error below 2e-7 (float)
// and 5e-16 (double) for |x| <= 87 (float) and 708 (double); beyond that the value there. NaN gives
// NaN.
[[nodiscard]] EIGEN_ALWAYS_INLINE double exponential(double x) {
  const detail::ExponentialParts<double> parts = detail::exponential_parts(x);
  return parts.up / parts.down;
}
[[nodiscard]] EIGEN_ALWAYS_INLINE float exponential(float x) {
  OFFNOMINAL_SUMS_IN_ORDER
  const float at = detail::held<float>(x, 87.0F);
  constexpr float kRounding = 12582912.0F;  // 1.5 * 2^23
  const float shifted = at * 1.44269504088896341F + kRounding;
  const float n = shifted - kRounding;
  const float r = (at - n * 0.693359375F) + n * 2.12194440e-4F;
  const float p =
      5.0000001201e-1F +
      r * (1.6666665459e-1F +
           r * (4.1665795894e-2F +
                r * (8.3334519073e-3F + r * (1.3981999507e-3F + r * 1.9875691500e-4F))));
  const std::uint32_t exponent = (std::bit_cast<std::uint32_t>(shifted) + 127U) & 0xFFU;
  return std::bit_cast<float>(exponent << 23U) * (1.0F + (r + r * r * p));
}

}  // namespace offnominal
