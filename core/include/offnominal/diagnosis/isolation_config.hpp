#pragma once

#include <offnominal/finite.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// What isolation is told beside the monitor's own configuration. The defaults were chosen on a
// seven-joint arm (docs/diagnosis.md) and have no unit of that arm in them.
template <typename Scalar>
struct IsolationConfig {
  Scalar block_s = Scalar(0.02);        // over which the unmodelled torque is averaged
  Scalar baseline_s = Scalar(10);       // how long the model's own error is remembered
  Scalar sign_width = Scalar(0.005);    // of friction at a reversal, rad/s or m/s
  Scalar relative_error = Scalar(0.1);  // by which a hypothesis may be off and still be right
  Scalar contact_s = Scalar(0.5);       // how long a push stays what it is, where it goes on
  Scalar confidence = Scalar(0.99);     // from which on it is decided
  Scalar least_s = Scalar(0.3);         // after the detection, before which it is not
  Scalar limit_s = Scalar(4);           // after the detection, at which it is in any case
};

// kInvalidLimit where a time is not above 0, least_s is above limit_s, or a share is not inside
// (0, 1).
template <typename Scalar>
[[nodiscard]] Status validate(const IsolationConfig<Scalar>& config) {
  for (const Scalar value :
       {config.block_s, config.baseline_s, config.sign_width, config.contact_s, config.least_s,
        config.limit_s, config.relative_error, config.confidence}) {
    if (!is_finite(value) || value <= 0) return Status::kInvalidLimit;
  }
  const bool shares = config.relative_error < 1 && config.confidence < 1;
  return shares && config.least_s <= config.limit_s ? Status::kOk : Status::kInvalidLimit;
}

}  // namespace offnominal
