#pragma once

namespace offnominal {

// The filter W_alpha over one tick, as the estimator's Runge-Kutta step has it: a state y with the
// input x, linear from x_begin to x_end inside the tick, ends at
// keep * y + begin * x_begin + end * x_end.
template <typename Scalar>
struct TickFilter {
  Scalar keep{};
  Scalar begin{};
  Scalar end{};
};

// alpha in 1/s, the period in s.
template <typename Scalar>
[[nodiscard]] constexpr TickFilter<Scalar> tick_filter(Scalar alpha, Scalar period_s) {
  const auto step = [&](Scalar y, Scalar x_begin, Scalar x_end) {
    const Scalar half = Scalar(0.5);
    const Scalar x_middle = half * (x_begin + x_end);
    const Scalar k1 = x_begin - alpha * y;
    const Scalar k2 = x_middle - alpha * (y + half * period_s * k1);
    const Scalar k3 = x_middle - alpha * (y + half * period_s * k2);
    const Scalar k4 = x_end - alpha * (y + period_s * k3);
    return y + period_s / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  };
  return {step(1, 0, 0), step(0, 1, 0), step(0, 0, 1)};
}

}  // namespace offnominal
