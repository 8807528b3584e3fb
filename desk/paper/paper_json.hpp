// Results of the paper's experiment as JSON. Times in s, angles in rad.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "paper/paper_runs.hpp"

namespace offnominal::desk::paper {

/// fault, accommodate, fault_time_s, detection_time_s, guaranteed_detection_time_s,
/// max_error_to_threshold_before_fault, max_abs_psi_hat_before_fault, tracking_rms_rad,
/// fault_estimate_relative_error, max_weight_norm, steps, scalar, seed. Null where there is none.
/// tracking_rms_m beside them, where joints slide.
[[nodiscard]] nlohmann::ordered_json to_json(const ExperimentResult& result);

/// resolution, smallest_detected_mass_loss, largest_undetected_mass_loss (shares of mass 1, null
/// where there is none), false_alarm_s, probes: [{mass_loss, detection_time_s}].
[[nodiscard]] nlohmann::ordered_json to_json(const SweepResult& sweep);

/// runs: [...], sweep: {...}, comparison: [{what, paper, here, agrees}], verdict. agrees is null
/// where the paper gives nothing to measure against.
[[nodiscard]] nlohmann::ordered_json to_json(const PaperRuns& runs,
                                             const std::vector<Comparison>& lines,
                                             const std::string& verdict);

}  // namespace offnominal::desk::paper
