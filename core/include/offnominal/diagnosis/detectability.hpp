#pragma once

#include <cmath>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>

// Which faults are certain to be seen, and by when. Derivations: docs/theory.md.

namespace offnominal {

// Theorem 4.2: a fault whose filtered size |eta| exceeds twice the threshold is detected whatever
// the uncertainty within its bound does. eta = W_alpha [beta psi]; both in rad/s or m/s.
template <typename Scalar>
[[nodiscard]] constexpr bool detection_guaranteed(Scalar eta_norm, Scalar mu) {
  return eta_norm > Scalar(2) * mu;
}

// The class of faults of corollary 4.4 with the margin that makes it hold (erratum 4): bound
// mu_bar <= K everywhere, |psi| >= 2 margin K with a constant direction, profile
// 1 - exp(-rho (t - T)).
struct FaultClass {
  double alpha = 10;         // pole of the filter, 1/s, > 0
  double rho = 0.5;          // evolution rate, 1/s, > 0; infinity: abrupt
  double margin = 2;         // r, > 1: how many times 2 K the fault is
  double fault_time_s = 10;  // T, s, >= 0
};

// For a fault whose components only keep their signs, not its direction: the margin to use in
// place of r for n joints.
[[nodiscard]] inline double margin_for_constant_signs(double margin, int joints) {
  return margin / std::sqrt(static_cast<double>(joints));
}

namespace detail {

[[nodiscard]] inline bool has_guarantee(const FaultClass& fault) {
  const bool rates = is_finite(fault.alpha) && fault.alpha > 0 &&
                     (is_infinite(fault.rho) ? fault.rho > 0 : fault.alpha > fault.rho) &&
                     fault.rho > 0;
  return rates && is_finite(fault.margin) && fault.margin > 1 && is_finite(fault.fault_time_s) &&
         fault.fault_time_s >= 0;
}

// |eta| - 2 mu at s after the fault, in the worst case, divided by 2 K / alpha.
[[nodiscard]] inline double worst_case_margin(const FaultClass& fault, double s) {
  const double a = fault.alpha;
  const double filtered =
      is_infinite(fault.rho)
          ? -std::expm1(-a * s)
          : 1 - (a * std::exp(-fault.rho * s) - fault.rho * std::exp(-a * s)) / (a - fault.rho);
  return fault.margin * filtered + std::expm1(-a * (s + fault.fault_time_s));
}

}  // namespace detail

// Closed form, a little above the exact bound: the delay t_d - T in s. kNoGuarantee where
// margin <= 1, alpha <= rho (for a finite rho) or a number is not in its range; delay_s unchanged.
[[nodiscard]] inline Status detection_delay_closed_form(const FaultClass& fault, double& delay_s) {
  if (!detail::has_guarantee(fault)) return Status::kNoGuarantee;
  const double r = fault.margin;
  delay_s = is_infinite(fault.rho)
                ? std::log(r / (r - 1)) / fault.alpha
                : std::log(fault.alpha * r / ((fault.alpha - fault.rho) * (r - 1))) / fault.rho;
  return Status::kOk;
}

// The bound itself: the largest delay t_d - T in s over every uncertainty and fault of the class,
// attained by the worst case of the proof. Bisection to the last bit; not for the control tick.
[[nodiscard]] inline Status detection_delay_bound(const FaultClass& fault, double& delay_s) {
  double high = 0;
  const Status status = detection_delay_closed_form(fault, high);
  if (status != Status::kOk) return status;
  // The margin falls from <= 0 at the fault, then rises through its only root, which lies at or
  // below the closed form.
  double low = 0;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = low + (high - low) / 2;
    if (middle <= low || middle >= high) break;
    (detail::worst_case_margin(fault, middle) > 0 ? high : low) = middle;
  }
  delay_s = high;
  return Status::kOk;
}

}  // namespace offnominal
