#pragma once

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstdint>
#include <type_traits>

// Whether numbers are numbers, read from their bits. A compiler that is told to know neither NaN
// nor infinity (-ffinite-math-only, a part of -ffast-math) leaves out std::isfinite, x == x and
// every comparison that is written so that NaN fails it. Hence the rule at every gate: is_finite()
// or is_nan() first, comparisons only of what has passed.

// exponential() and sine_cosine() round by adding a large number and taking it away again, and sum
// small parts after large ones. A compiler that is told to reorder sums makes other functions of
// them: the sine of 10.3 rad would be -1.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__)
#error \
    "offnominal: not with -ffast-math, -Ofast or -fassociative-math: sums must keep their order. \
Compile what includes these headers with -fno-fast-math; -fno-math-errno is allowed and as fast"
#endif

// At the beginning of a function whose sums must keep their order: Clang has no macro that tells
// -fassociative-math alone, but takes orders for a scope.
#ifdef __clang__
#define OFFNOMINAL_SUMS_IN_ORDER _Pragma("clang fp reassociate(off)")
#else
#define OFFNOMINAL_SUMS_IN_ORDER
#endif

namespace offnominal {

namespace detail {

// The bits of the magnitude, moved to the upper end; infinity's are the smallest of those that are
// no numbers.
[[nodiscard]] constexpr std::uint32_t magnitude_bits(const float& x) {
  return std::bit_cast<std::uint32_t>(x) << 1U;
}
[[nodiscard]] constexpr std::uint64_t magnitude_bits(const double& x) {
  return std::bit_cast<std::uint64_t>(x) << 1U;
}
template <typename Scalar>
inline constexpr auto kInfinityBits = std::uint32_t{0xFF000000};
template <>
inline constexpr auto kInfinityBits<double> = std::uint64_t{0xFFE0000000000000};

}  // namespace detail

template <std::floating_point Scalar>
[[nodiscard]] constexpr bool is_finite(const Scalar& x) {
  return detail::magnitude_bits(x) < detail::kInfinityBits<Scalar>;
}
template <std::floating_point Scalar>
[[nodiscard]] constexpr bool is_nan(const Scalar& x) {
  return detail::magnitude_bits(x) > detail::kInfinityBits<Scalar>;
}
template <std::floating_point Scalar>
[[nodiscard]] constexpr bool is_infinite(const Scalar& x) {
  return detail::magnitude_bits(x) == detail::kInfinityBits<Scalar>;
}

// Values: an array or a vector of numbers, at least one. The largest decides: no branch per number.
template <typename Values>
[[nodiscard]] constexpr bool all_finite(const Values& values) {
  auto largest = detail::magnitude_bits(values[0]);
  for (const auto& value : values) largest = std::max(largest, detail::magnitude_bits(value));
  using Scalar = std::remove_cvref_t<decltype(values[0])>;
  return largest < detail::kInfinityBits<Scalar>;
}

}  // namespace offnominal
