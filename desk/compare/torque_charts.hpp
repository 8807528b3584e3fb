#pragma once

#include <string>
#include <vector>

#include "compare/compare.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// One model's torque, and how its curve is called.
struct NamedComparison {
  std::string name;  // "model", "with coulomb_friction"
  const Comparison* comparison = nullptr;
  report::Tone tone = report::Tone::kModel;
};

// Measured torque of one joint and that of every model over time. All comparisons are of one
// recording.
report::Chart torque_over_time(const std::vector<NamedComparison>& models, std::size_t joint);

// The residual of every model over time.
report::Chart residual_over_time(const std::vector<NamedComparison>& models, std::size_t joint);

// The residuals over a variable of the motion, sample by sample, with the mean of each over 40
// equally filled bins.
enum class MotionVariable { kPosition, kVelocity, kAcceleration };
report::Chart residual_over(const std::vector<NamedComparison>& models, std::size_t joint,
                            MotionVariable variable);

}  // namespace offnominal::desk
