#include <fmt/format.h>

#include "calibrate/calibrate_report.hpp"
#include "common/amount.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "common/text_table.hpp"
#include "robot/bound_names.hpp"

namespace offnominal::desk {
namespace {

std::string list_text(const std::vector<double>& values) {
  return "[" + list_of(values, shortest) + "]";
}

std::string matrix_text(const std::vector<std::vector<double>>& matrix) {
  return "[" + list_of(matrix, list_text) + "]";
}

// " rad/s"; of joints that turn and joints that slide together there is none.
std::string spaced(const std::string& unit) { return unit == "1" ? "" : " " + unit; }
// "rad/s" -> " rad/s^2"
std::string per_second(const std::string& unit) { return unit == "1" ? "" : " " + unit + "^2"; }

std::string threshold_text(const std::optional<double>& value) {
  return value ? fmt::format("{:.4g}", *value) : std::string("none");
}

std::string stretches_text(const std::vector<JudgedStretch>& stretches) {
  const TextTable table({{"recording", -28},
                         {"from s", 8},
                         {"to s", 9},
                         {"", -11},
                         {"mean mu", 9},
                         {"", 9},
                         {"|e| / mu", 9},
                         {"", 8},
                         {"alarms", 7}},
                        "  ");
  std::string text = table.heading() + table.row("", "", "", "", "old", "new", "old", "new", "new");
  for (const JudgedStretch& stretch : stretches) {
    text += table.row(
        stretch.file, fmt::format("{:.3f}", stretch.begin_s), fmt::format("{:.3f}", stretch.end_s),
        stretch.held_out ? " hold-out" : " calibrated",
        threshold_text(stretch.mean_threshold_before),
        fmt::format("{:.4g}", stretch.mean_threshold_after),
        stretch.max_ratio_before ? fmt::format("{:.3f}", *stretch.max_ratio_before) : "none",
        fmt::format("{:.3f}", stretch.max_ratio_after), stretch.alarms_after);
  }
  return text;
}

std::string shapes_text(const std::vector<ShapeScore>& shapes) {
  const TextTable table(
      {{"", 1}, {"shapes tried", -56}, {"unseen", 6}, {"widened", 9}, {"mean mu", 9}}, "  ");
  std::string text = table.heading();
  for (const ShapeScore& shape : shapes) {
    text += table.row(
        shape.chosen ? "*" : " ", shape.words, fmt::format("{:.3f}", shape.largest_unseen_ratio),
        fmt::format("{:.3f}", shape.widening), fmt::format("{:.4g}", shape.mean_threshold));
  }
  return text;
}

}  // namespace

std::string words_of(const BoundSettings& bound, const std::string& unit) {
  const std::string acceleration = per_second(unit);
  std::string words;
  switch (bound.kind) {
    case BoundSettings::Kind::kConstant:
      words = fmt::format("constant {}{}", shortest(bound.constant.value), acceleration);
      break;
    case BoundSettings::Kind::kScaledNorm:
      words = fmt::format("{} (|{} dq| + {}){}", shortest(bound.scaled_norm.scale),
                          matrix_text(bound.scaled_norm.matrix), shortest(bound.scaled_norm.offset),
                          acceleration);
      break;
    case BoundSettings::Kind::kTable:
      words = fmt::format("table over {} of joint {}: {} at {}{}",
                          bound_variable_names(bound.table.variable).name, bound.table.joint + 1,
                          list_text(bound.table.value), list_text(bound.table.at),
                          acceleration.empty() ? "" : "," + acceleration);
      break;
    case BoundSettings::Kind::kPerJoint:  // said joint by joint (joints_report.cpp)
      break;
  }
  if (bound.velocity_error > 0) {
    words += fmt::format("; velocity error {}{}", shortest(bound.velocity_error), spaced(unit));
  }
  return words;
}

std::string remarks_text(const std::vector<std::string>& notes,
                         const std::vector<std::string>& objections) {
  std::string text;
  for (const std::string& note : notes) text += "note: " + note + "\n";
  for (const std::string& objection : objections) text += "not written: " + objection + "\n";
  return text;
}

std::string verdict_of(const Calibration& calibration) {
  if (!calibration.objections.empty()) {
    return "These recordings give no bound that can be trusted. " + calibration.objections.front();
  }
  const BoundMargin margin = margin_of(calibration);
  std::string words = fmt::format("The threshold is {:.3g}{} on average", margin.mean_after,
                                  spaced(calibration.unit));
  if (margin.mean_before) {
    words += fmt::format(", {:.2g} times the old one's {:.3g}{}",
                         margin.mean_after / *margin.mean_before, *margin.mean_before,
                         spaced(calibration.unit));
  }
  words += fmt::format("; the recordings reach {:.3g} of it at most", margin.largest_ratio_after);
  if (margin.largest_ratio_before) {
    words += fmt::format(", {:.3g} of the old one", *margin.largest_ratio_before);
  }
  const FalseAlarmLevel& level = calibration.level;
  return words + fmt::format("; {} in {:g} s of hold-out data.",
                             counted(static_cast<std::size_t>(level.held_out_alarms), "alarm"),
                             level.held_out_s);
}

std::string text_of(const Calibration& calibration, const CalibrateNames& names) {
  const FalseAlarmLevel& level = calibration.level;
  std::string text = fmt::format("uncertainty bound of {}\n", names.robot);
  text += fmt::format("  old  {}\n", calibration.old_bound
                                         ? words_of(*calibration.old_bound, calibration.unit)
                                         : std::string("none"));
  text += fmt::format("  new  {}\n\n", words_of(*calibration.robot.bound, calibration.unit));
  text += stretches_text(calibration.stretches) + "\n" + shapes_text(calibration.shapes);
  text += fmt::format(
      "\nfalse alarms: {:g} per hour, extrapolated from the maxima of {} blocks of {:g} s that the "
      "bound had not seen\n(extreme-value law with shape {:.3g}; blocks taken as independent, "
      "motions as in these recordings)\ncounted on hold-out data: {} in {:g} s, which by "
      "itself excludes more than {:.3g} per hour (95 %)\n",
      level.alarms_per_hour, level.blocks, level.block_s, level.law.shape,
      counted(static_cast<std::size_t>(level.held_out_alarms), "alarm"), level.held_out_s,
      level.highest_per_hour);
  return text + remarks_text(calibration.notes, calibration.objections) + verdict_of(calibration) +
         "\n";
}

}  // namespace offnominal::desk
