#pragma once

#include <cstdint>
#include <offnominal/diagnosis/dead_zone.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// Settings of the nonlinear estimator (paper section 3). Defaults are the paper's where it prints
// one.
template <typename Scalar>
struct EstimatorConfig {
  Scalar period_s = Scalar(0.001);     // length of a tick, > 0
  Scalar alpha = 10;                   // pole of the filter 1/(s + alpha), 1/s, > 0
  Scalar learning_rate = Scalar(2.5);  // Gamma = learning_rate I (erratum 3), >= 0; 0 detects only
  Scalar weight_radius = 10;           // M: |theta| never exceeds it, > 0
  DeadZone dead_zone = DeadZone::kContinuous;
  int hidden_units = 35;                      // in use; at most the capacity L
  Scalar initial_weight_range = Scalar(0.1);  // W1(0) is uniform in [-range, range], > 0
  std::uint32_t seed = 1;                     // of W1(0)
};

// The explicit Runge-Kutta step of the filter is stable up to alpha * period = 2.785; beyond 1 it
// no longer resembles the filter.
inline constexpr double kMaxPolePerTick = 1.0;

// NaN and infinity fail every check.
template <int L, typename Scalar>
[[nodiscard]] Status validate(const EstimatorConfig<Scalar>& config) {
  const auto positive = [](Scalar x) { return is_finite(x) && x > 0; };
  if (!positive(config.period_s)) return Status::kInvalidPeriod;
  if (!positive(config.alpha)) return Status::kInvalidFilterPole;
  if (config.alpha * config.period_s > static_cast<Scalar>(kMaxPolePerTick)) {
    return Status::kUnstablePeriod;
  }
  if (!is_finite(config.learning_rate) || config.learning_rate < 0) {
    return Status::kInvalidLearningRate;
  }
  if (!positive(config.weight_radius)) return Status::kInvalidWeightRadius;
  if (config.hidden_units < 1 || config.hidden_units > L) return Status::kInvalidHiddenUnits;
  return positive(config.initial_weight_range) ? Status::kOk : Status::kInvalidInitialWeights;
}

}  // namespace offnominal
