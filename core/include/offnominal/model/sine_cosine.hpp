#pragma once

#include <Eigen/Core>
#include <bit>
#include <concepts>
#include <cstdint>
#include <offnominal/finite.hpp>

namespace offnominal {

template <typename Scalar>
struct SineCosine {
  Scalar sine{};
  Scalar cosine{};
};

namespace detail {

// pi/2 in three parts, of which the first two leave room for a factor of 13 (float) or 20 (double)
// bits without rounding; and the number that rounds to a whole one what is added to it.
template <typename Scalar>
struct QuarterTurn;
template <>
struct QuarterTurn<float> {
  static constexpr float kParts[3] = {1.5703125F, 4.837512969970703125e-4F,
                                      7.54978995489188216e-8F};
  static constexpr float kPerRadian = 0.636619772367581F;
  static constexpr float kRounding = 12582912.0F;  // 1.5 * 2^23
  using Bits = std::uint32_t;
};
template <>
struct QuarterTurn<double> {
  static constexpr double kParts[3] = {1.57079632673412561417, 6.07710050630396597660e-11,
                                       2.02226624879595063154e-21};
  static constexpr double kPerRadian = 0.63661977236758134308;
  static constexpr double kRounding = 6755399441055744.0;  // 1.5 * 2^52
  using Bits = std::uint64_t;
};

// Both of r in [-pi/4, pi/4]; float: Cephes (S. L. Moshier), double: fdlibm (Sun Microsystems,
// 1993).
[[nodiscard]] EIGEN_ALWAYS_INLINE SineCosine<float> sine_cosine_near_zero(float r) {
  const float z = r * r;
  const float sine =
      r + r * (z * (-1.6666654611e-1F + z * (8.3321608736e-3F - z * 1.9515295891e-4F)));
  const float cosine =
      1.0F + z * (-0.5F + z * (4.166664568298827e-2F +
                               z * (-1.388731625493765e-3F + z * 2.443315711809948e-5F)));
  return {sine, cosine};
}
[[nodiscard]] EIGEN_ALWAYS_INLINE SineCosine<double> sine_cosine_near_zero(double r) {
  const double z = r * r;
  const double s = 8.33333333332248946124e-3 +
                   z * (-1.98412698298579493134e-4 +
                        z * (2.75573137070700676789e-6 +
                             z * (-2.50507602534068634195e-8 + z * 1.58969099521155010221e-10)));
  const double c =
      4.16666666666666019037e-2 +
      z * (-1.38888888888741095749e-3 +
           z * (2.48015872894767294178e-5 +
                z * (-2.75573143513906633035e-7 +
                     z * (2.08757232129817482790e-9 - z * 1.13596475577881948265e-11))));
  return {r + r * (z * (-1.66666666666666324348e-1 + z * s)), 1.0 + z * (-0.5 + z * c)};
}

}  // namespace detail

// sin(angle) and cos(angle), rad; the same work for every argument, no branches and no call.
// Absolute error below 1.5e-7 up to 1e4 rad (float), 4e-16 up to 1e5 rad (double); far beyond that
// the pair is bounded and means nothing. Non-finite gives NaN.
template <std::floating_point Scalar>
[[nodiscard]] EIGEN_ALWAYS_INLINE SineCosine<Scalar> sine_cosine(Scalar angle) {
  OFFNOMINAL_SUMS_IN_ORDER
  using Quarter = detail::QuarterTurn<Scalar>;
  const Scalar shifted = angle * Quarter::kPerRadian + Quarter::kRounding;
  const Scalar quarters = shifted - Quarter::kRounding;
  Scalar r = angle - quarters * Quarter::kParts[0];
  r -= quarters * Quarter::kParts[1];
  r -= quarters * Quarter::kParts[2];
  constexpr auto kMost = static_cast<Scalar>(0.8);  // pi/4 and rounding
  r = r > kMost ? kMost : r;
  r = r < -kMost ? -kMost : r;
  const SineCosine<Scalar> near = detail::sine_cosine_near_zero(r);
  const auto quadrant = std::bit_cast<typename Quarter::Bits>(shifted);
  const bool swapped = (quadrant & 1U) != 0;
  const Scalar sine = swapped ? near.cosine : near.sine;
  const Scalar cosine = swapped ? near.sine : near.cosine;
  return {(quadrant & 2U) != 0 ? -sine : sine, ((quadrant + 1U) & 2U) != 0 ? -cosine : cosine};
}

}  // namespace offnominal
