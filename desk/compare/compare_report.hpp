#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "compare/before_after.hpp"
#include "compare/compare.hpp"
#include "report/page.hpp"

namespace offnominal::desk {

// What was compared, as the user named it.
struct CompareNames {
  std::vector<std::string> logs;
  std::string robot_file;
  std::string command_line;
  std::string against_file = {};  // the older robot file; empty: none
};

// In the following `against` is an older model on the same recordings, null where none was asked
// for: then the fall of the error from it stands beside the error.

// One sentence per joint: how much of the torque the model misses, over all recordings together,
// and what the error follows.
std::string verdict_of(const Comparisons& comparisons, const Comparisons* against = nullptr);
report::Level level_of(const Comparisons& comparisons);

// {logs, robot, joints: [{joint, unit, rms_error, rms_torque, relative_error_percent, fit_percent,
// left_out_percent}], where: [{joint, variable, share_of_residual}], samples, recordings: [{log,
// joints, where, samples, filter, remarks, payload: {mass_kg, place_m}}], verdict}; payload is null
// where none is known. `joints` and `where` are of all recordings together; of a single one there
// are also its log, filter and remarks beside them. Joints count from 1. A percentage that does not
// exist (no torque at all) is null. With an older model also against: {robot, joints: [{joint,
// unit, rms_error, relative_error_percent, fall_percent}]}, the fall being that of the rms error;
// so in each of the recordings.
nlohmann::ordered_json to_json(const Comparisons& comparisons, const CompareNames& names,
                               const Comparisons* against = nullptr);
// {sample_rate_hz, position_cutoff_hz, torque_cutoff_hz, cutoff_from, cutoff_joint, decimation}:
// the same keys in every verb that filters. No cut-off is null; cutoff_joint is null but for an
// encoder.
nlohmann::ordered_json to_json(const FilterPlan& plan);
nlohmann::ordered_json to_json(const std::optional<Payload>& payload);

// The same for people, with a line break at its end.
std::string text_of(const Comparisons& comparisons, const CompareNames& names,
                    const Comparisons* against = nullptr);

// "position low-pass 20 Hz, torque low-pass 8 Hz by the encoder of joint 1, one sample of 24 at 500
// Hz"
std::string words_of(const FilterPlan& plan);
// "default", "sampling_rate", "encoder", "--cutoff", "--decimate", "at_rest"
std::string name_of(CutoffReason::Kind kind);

// Errors before and after on some of the data, and what these are called.
struct NamedErrors {
  std::string data;
  std::vector<BeforeAfter> joints;
};
// A line per joint of each; `plan`: the filter of all of them.
report::Table before_after_table(const std::vector<NamedErrors>& errors, const FilterPlan& plan);

// Measured against model torque over time; the residual over time, position, velocity and
// acceleration: of the recording that the reader chooses.
report::Page page_of(const Comparisons& comparisons, const CompareNames& names,
                     const Comparisons* against = nullptr);

}  // namespace offnominal::desk
