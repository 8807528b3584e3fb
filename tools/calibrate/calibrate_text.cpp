#include <fmt/format.h>

#include "calibrate/calibrate_report.hpp"
#include "common/number.hpp"

namespace offnominal::tools {
namespace {

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + shortest(value);
  return "[" + text + "]";
}

std::string matrix_text(const std::vector<std::vector<double>>& matrix) {
  std::string text;
  for (const auto& row : matrix) text += (text.empty() ? "" : ", ") + list_text(row);
  return "[" + text + "]";
}

// "rad/s" -> "rad/s^2"
std::string per_second(const std::string& unit) { return unit == "1" ? unit : unit + "^2"; }

std::string threshold_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : std::string("none");
}

std::string stretch_text(const JudgedStretch& stretch) {
  return fmt::format("  {:<28} {:>8.3f} {:>9.3f}  {:<10} {:>9} {:>9.4g} {:>9} {:>8.3f} {:>7}\n",
                     stretch.file, stretch.begin_s, stretch.end_s,
                     stretch.held_out ? "hold-out" : "calibrated",
                     threshold_text(stretch.mean_threshold_before), stretch.mean_threshold_after,
                     stretch.max_ratio_before ? fmt::format("{:.3f}", *stretch.max_ratio_before)
                                              : std::string("none"),
                     stretch.max_ratio_after, stretch.alarms_after);
}

}  // namespace

std::string words_of(const BoundSettings& bound, const std::string& unit) {
  const std::string acceleration = per_second(unit);
  std::string words;
  switch (bound.kind) {
    case BoundSettings::Kind::kConstant:
      words = fmt::format("constant {} {}", shortest(bound.constant.value), acceleration);
      break;
    case BoundSettings::Kind::kScaledNorm:
      words = fmt::format("{} (|{} dq| + {}) {}", shortest(bound.scaled_norm.scale),
                          matrix_text(bound.scaled_norm.matrix), shortest(bound.scaled_norm.offset),
                          acceleration);
      break;
    case BoundSettings::Kind::kTable: {
      const char* const variables[]{"position", "speed", "torque"};
      words = fmt::format("table over {} of joint {}: {} at {}, {}",
                          variables[static_cast<std::size_t>(bound.table.variable)],
                          bound.table.joint + 1, list_text(bound.table.value),
                          list_text(bound.table.at), acceleration);
      break;
    }
  }
  if (bound.velocity_error > 0) {
    words += fmt::format("; velocity error {} {}", shortest(bound.velocity_error), unit);
  }
  return words;
}

std::string verdict_of(const Calibration& calibration) {
  if (!calibration.objections.empty()) {
    return "These recordings give no bound that can be trusted. " + calibration.objections.front();
  }
  const BoundMargin margin = margin_of(calibration);
  std::string words =
      fmt::format("The threshold is {:.3g} {} on average", margin.mean_after, calibration.unit);
  if (margin.mean_before) {
    words +=
        fmt::format(", {:.2g} times the old one's {:.3g} {}",
                    margin.mean_after / *margin.mean_before, *margin.mean_before, calibration.unit);
  }
  words += fmt::format("; the recordings reach {:.3g} of it at most", margin.largest_ratio_after);
  if (margin.largest_ratio_before) {
    words += fmt::format(", {:.3g} of the old one", *margin.largest_ratio_before);
  }
  const FalseAlarmLevel& level = calibration.level;
  return words + fmt::format("; {} alarm(s) in {:g} s of hold-out data.", level.held_out_alarms,
                             level.held_out_s);
}

std::string text_of(const Calibration& calibration, const CalibrateNames& names) {
  const FalseAlarmLevel& level = calibration.level;
  std::string text = fmt::format("uncertainty bound of {}\n", names.robot);
  text += fmt::format("  old  {}\n", calibration.old_bound
                                         ? words_of(*calibration.old_bound, calibration.unit)
                                         : std::string("none"));
  text += fmt::format("  new  {}\n\n", words_of(*calibration.robot.bound, calibration.unit));
  text += fmt::format("  {:<28} {:>8} {:>9}  {:<10} {:>9} {:>9} {:>9} {:>8} {:>7}\n", "recording",
                      "from s", "to s", "", "mean mu", "", "|e| / mu", "", "alarms");
  text += fmt::format("  {:<28} {:>8} {:>9}  {:<10} {:>9} {:>9} {:>9} {:>8} {:>7}\n", "", "", "",
                      "", "old", "new", "old", "new", "new");
  for (const JudgedStretch& stretch : calibration.stretches) text += stretch_text(stretch);
  text += fmt::format("\n  shapes tried {:>53} {:>9} {:>9}\n", "unseen", "widened", "mean mu");
  for (const ShapeScore& shape : calibration.shapes) {
    text +=
        fmt::format("  {} {:<56} {:>6.3f} {:>9.3f} {:>9.4g}\n", shape.chosen ? "*" : " ",
                    shape.words, shape.largest_unseen_ratio, shape.widening, shape.mean_threshold);
  }
  text += fmt::format(
      "\nfalse alarms: {:g} per hour, extrapolated from the maxima of {} blocks of {:g} s that the "
      "bound had not seen\n(extreme-value law with shape {:.3g}; blocks taken as independent, "
      "motions as in these recordings)\ncounted on hold-out data: {} alarm(s) in {:g} s, which by "
      "itself excludes more than {:.3g} per hour (95 %)\n",
      level.alarms_per_hour, level.blocks, level.block_s, level.law.shape, level.held_out_alarms,
      level.held_out_s, level.highest_per_hour);
  for (const std::string& note : calibration.notes) text += "note: " + note + "\n";
  for (const std::string& objection : calibration.objections) {
    text += "not written: " + objection + "\n";
  }
  return text + verdict_of(calibration) + "\n";
}

}  // namespace offnominal::tools
