#include <algorithm>

#include "calibrate/calibrate.hpp"

namespace offnominal::desk {

ErrorWords words_of_joint() {
  return {"residual", "the residual", "residual / threshold", "of its threshold", true};
}

BoundMargin margin_of(const Calibration& calibration) {
  BoundMargin margin;
  double samples = 0;
  double before = 0;
  double after = 0;
  for (const JudgedStretch& stretch : calibration.stretches) {
    const auto weight = static_cast<double>(stretch.samples);
    samples += weight;
    before += weight * stretch.mean_threshold_before.value_or(0);
    after += weight * stretch.mean_threshold_after;
    margin.largest_ratio_after = std::max(margin.largest_ratio_after, stretch.max_ratio_after);
    if (stretch.max_ratio_before) {
      margin.largest_ratio_before =
          std::max(margin.largest_ratio_before.value_or(0), *stretch.max_ratio_before);
    }
  }
  margin.mean_after = after / samples;
  if (!calibration.old_bound) return margin;
  margin.mean_before = before / samples;
  if (before > 0) margin.new_to_old = after / before;
  return margin;
}

}  // namespace offnominal::desk
