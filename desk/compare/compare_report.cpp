#include "compare/compare_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/effort_name.hpp"
#include "common/nearest.hpp"
#include "common/text_table.hpp"
#include "compare/torque_charts.hpp"

namespace offnominal::desk {
namespace {

using report::Level;

// Shares of the torque's norm that a model may miss. With less than the first a computed-torque
// controller is limited by its feedback; beyond the second the model lacks a main part.
constexpr double kGoodPercent = 5;
constexpr double kPoorPercent = 20;
// What an error follows is worth saying from this share on, unless the error is next to nothing.
constexpr double kWorthSaying = 0.3;
constexpr double kNextToNothingPercent = 1;

std::string percent(double value) {
  return std::isfinite(value) ? fmt::format("{:.2f} %", value) : std::string("none");
}

std::string sentence(const GearTorque& gear, const std::string& unit) {
  std::string words =
      fmt::format("Drive less sensor, gear and rotor take {:.4g} {} rms ({} of the drive's {})",
                  gear.rms, unit, percent(gear.percent), effort_name(unit));
  if (gear.follows.share >= kWorthSaying) {
    words += fmt::format(", {:.0f} % of it follows the {}", 100 * gear.follows.share,
                         gear.follows.variable);
  }
  return words + ".";
}

std::string sentence(const JointComparison& joint) {
  const char* effort = effort_name(joint.unit);
  if (joint.samples == 0) {
    return fmt::format("Joint {}: nothing is left of it that is free of faults of the recording.",
                       joint.joint + 1);
  }
  if (!std::isfinite(joint.relative_error_percent)) {
    return fmt::format("Joint {}: the recorded {} is 0 throughout, nothing to compare with.",
                       joint.joint + 1, effort);
  }
  const char* quality = joint.relative_error_percent <= kGoodPercent   ? "good"
                        : joint.relative_error_percent <= kPoorPercent ? "fair"
                                                                       : "poor";
  std::string words = fmt::format(
      "Joint {}: {}. The model misses {:.1f} % of the {} ({:.4g} {} rms of {:.4g} {} rms).",
      joint.joint + 1, quality, joint.relative_error_percent, effort, joint.rms_error, joint.unit,
      joint.rms_torque, joint.unit);
  const ErrorShare& first = joint.where.front();
  if (joint.relative_error_percent > kNextToNothingPercent && first.share >= kWorthSaying) {
    words +=
        fmt::format(" {:.0f} % of the error follows the {}.", 100 * first.share, first.variable);
  }
  if (joint.gear) words += " " + sentence(*joint.gear, joint.unit);
  constexpr double kWorthMention = 0.01;
  const double at_rest = joint.left_out - joint.at_fault;
  if (at_rest >= kWorthMention) {
    words += fmt::format(
        " {:.0f} % of the samples do not count: the joint stands still there, and friction may "
        "hold "
        "it.",
        100 * at_rest);
  }
  if (joint.at_fault > 0) {
    words += fmt::format(
        " {:.1f} % of the samples are left out for faults of the recording; {} are left of this "
        "joint.",
        100 * joint.at_fault, joint.samples);
  }
  return words;
}

Level level_of(const JointComparison& joint) {
  if (joint.relative_error_percent <= kGoodPercent) return Level::kGood;
  return joint.relative_error_percent <= kPoorPercent ? Level::kWarn : Level::kBad;
}

report::KeyFigures key_figures(const Comparisons& comparisons) {
  report::KeyFigures keys;
  for (const JointComparison& joint : comparisons.joints) {
    report::KeyFigure relative;
    relative.label = fmt::format("relative error, joint {}", joint.joint + 1);
    relative.value = joint.relative_error_percent;
    relative.unit = "%";
    relative.format = ".2f";
    relative.level = level_of(joint);
    report::KeyFigure rms;
    rms.label = fmt::format("rms error, joint {}", joint.joint + 1);
    rms.value = joint.rms_error;
    rms.unit = joint.unit;
    rms.note = fmt::format("of {:.4g} {} rms", joint.rms_torque, joint.unit);
    keys.figures.push_back(relative);
    keys.figures.push_back(rms);
  }
  return keys;
}

bool are_several(const Comparisons& comparisons) { return comparisons.recordings.size() > 1; }

std::string number_of(std::size_t recording) { return std::to_string(recording + 1); }

report::Table table_of(const Comparisons& comparisons) {
  report::Table table;
  table.caption = "Error per joint";
  table.columns = {{"joint", "", "d"},  {"rms error", "", ".4g"},       {"rms torque", "", ".4g"},
                   {"unit", "", ".4g"}, {"relative error", "%", ".2f"}, {"fit", "%", ".2f"}};
  const bool several = are_several(comparisons);
  if (several) table.columns.insert(table.columns.begin() + 1, {"recording", "", ".4g"});
  const auto row = [&](const JointComparison& joint, const std::string& recording) {
    std::vector<report::Cell> cells{
        static_cast<double>(joint.joint + 1), joint.rms_error,  joint.rms_torque, joint.unit,
        joint.relative_error_percent,         joint.fit_percent};
    if (several) cells.insert(cells.begin() + 1, recording);
    table.rows.push_back(std::move(cells));
  };
  for (std::size_t i = 0; i < comparisons.joints.size(); ++i) {
    for (const Comparison& one : comparisons.recordings) {
      if (several) row(one.joints[i], one.file);
    }
    row(comparisons.joints[i], "all together");
  }
  table.note =
      "Relative error: 100 |tau - tau_m| / |tau|. Fit: 100 (1 - |tau - tau_m| / |tau - mean|). "
      "Both over the filtered samples: " +
      words_of(comparisons.recordings[0].plan) + (several ? ", the first recording." : ".");
  return table;
}

// Of one error, before and after: what columns hold it, and its cells.
std::vector<report::Column> columns_of_error() {
  return {{"joint", "", "d"},  {"rms before", "", ".4g"},       {"rms after", "", ".4g"},
          {"unit", "", ".4g"}, {"relative before", "%", ".2f"}, {"relative after", "%", ".2f"}};
}
std::vector<report::Cell> cells_of(const BeforeAfter& error) {
  return {static_cast<double>(error.joint + 1),
          error.before_rms,
          error.after_rms,
          error.unit,
          error.before_percent,
          error.after_percent};
}

report::Table fall_table(const Comparisons& comparisons, const Comparisons& against,
                         const CompareNames& names) {
  report::Table table;
  table.caption = "Fall of the error";
  table.columns = columns_of_error();
  table.columns.push_back({"fall", "%", ".1f"});
  for (const BeforeAfter& error : before_after(against.joints, comparisons.joints)) {
    table.rows.push_back(cells_of(error));
    table.rows.back().emplace_back(100 * error.fall());
  }
  table.note = "Before: " + names.against_file + ". Fall of the rms error; negative: it has grown.";
  if (are_several(comparisons)) table.note += " All recordings together.";
  return table;
}

report::Section joint_section(const Comparison& comparison, const Comparison* against,
                              std::size_t joint) {
  std::vector<NamedComparison> models{{"model", &comparison, report::Tone::kModel}};
  if (against != nullptr) models.insert(models.begin(), {"before", against, report::Tone::kFaint});
  report::Section section;
  section.heading = fmt::format("Joint {}", joint + 1);
  section.text =
      "The error follows, by the share of its energy that the mean over 40 bins explains:";
  for (const ErrorShare& where : comparison.joints[joint].where) {
    section.text += fmt::format(" {} {:.0f} %;", where.variable, 100 * where.share);
  }
  section.text.back() = '.';
  section.blocks.emplace_back(torque_over_time(models, joint));
  section.blocks.emplace_back(residual_over_time(models, joint));
  for (const ErrorVariable variable :
       {ErrorVariable::kVelocity, ErrorVariable::kPosition, ErrorVariable::kAcceleration}) {
    section.blocks.emplace_back(residual_over(models, joint, {variable, joint}));
  }
  return section;
}

// "../A.mat, 303 samples", a line each; what they are called in the table below.
std::string list_of_recordings(const Comparisons& comparisons) {
  std::string text;
  for (std::size_t r = 0; r < comparisons.recordings.size(); ++r) {
    const Comparison& one = comparisons.recordings[r];
    text +=
        fmt::format("recording {}: {}, {} samples left\n", number_of(r), one.file, one.t_s.size());
    for (const std::string& remark : one.remarks) text += "  note: " + remark + "\n";
  }
  return text;
}

std::string words_of_filters(const Comparisons& comparisons) {
  std::string text;
  std::string last;
  for (std::size_t r = 0; r < comparisons.recordings.size(); ++r) {
    const std::string words = words_of(comparisons.recordings[r].plan);
    if (words == last) continue;
    text += (r == 0 ? "" : fmt::format("from recording {}: ", number_of(r))) + words + "\n";
    last = words;
  }
  return text;
}

std::string error_table(const Comparisons& comparisons) {
  const bool several = are_several(comparisons);
  std::vector<TextColumn> columns{{"joint", -6}};
  if (several) columns.push_back({"recording", -10});
  for (const TextColumn& column : std::vector<TextColumn>{
           {"rms error", 14}, {"rms torque", 14}, {"relative error", 15}, {"fit", 10}}) {
    columns.push_back(column);
  }
  const TextTable table(columns);
  std::string text = table.heading();
  const auto row = [&](const JointComparison& joint, const std::string& recording) {
    // Where nothing is left of a joint there are none.
    const auto amount = [&](double value) {
      return std::isfinite(value) ? fmt::format("{:.4g} {}", value, joint.unit)
                                  : std::string("none");
    };
    const std::string error = amount(joint.rms_error);
    const std::string torque = amount(joint.rms_torque);
    const std::string relative = percent(joint.relative_error_percent);
    const std::string fit = percent(joint.fit_percent);
    text += several ? table.row(joint.joint + 1, recording, error, torque, relative, fit)
                    : table.row(joint.joint + 1, error, torque, relative, fit);
  };
  for (std::size_t i = 0; i < comparisons.joints.size(); ++i) {
    for (std::size_t r = 0; several && r < comparisons.recordings.size(); ++r) {
      row(comparisons.recordings[r].joints[i], number_of(r));
    }
    row(comparisons.joints[i], "all");
  }
  return text;
}

}  // namespace

std::string name_of(CutoffReason::Kind kind) {
  switch (kind) {
    case CutoffReason::Kind::kDefault:
      return "default";
    case CutoffReason::Kind::kRate:
      return "sampling_rate";
    case CutoffReason::Kind::kEncoder:
      return "encoder";
    case CutoffReason::Kind::kCutoff:
      return "--cutoff";
    case CutoffReason::Kind::kDecimate:
      return "--decimate";
    case CutoffReason::Kind::kAtRest:
      return "at_rest";
  }
  return "";
}

std::string verdict_of(const Comparisons& comparison, const Comparisons* against) {
  std::string words;
  if (against != nullptr) {
    for (const BeforeAfter& error : before_after(against->joints, comparison.joints)) {
      words += fmt::format("{}Joint {}: the error {} from {:.2f} % to {:.2f} %.",
                           words.empty() ? "" : " ", error.joint + 1,
                           error.fall() > 0 ? "falls" : "does not fall: it goes",
                           error.before_percent, error.after_percent);
    }
  }
  for (const JointComparison& joint : comparison.joints) {
    if (!words.empty()) words += " ";
    words += sentence(joint);
  }
  return words;
}

Level level_of(const Comparisons& comparison) {
  Level worst = Level::kGood;
  for (const JointComparison& joint : comparison.joints) worst = std::max(worst, level_of(joint));
  return worst;
}

namespace {

std::string words_of(const CutoffReason& reason) {
  if (reason.kind == CutoffReason::Kind::kEncoder)
    return fmt::format("the encoder of joint {}", reason.joint + 1);
  return reason.kind == CutoffReason::Kind::kRate ? "the sampling rate" : name_of(reason.kind);
}

}  // namespace

std::string words_of(const FilterPlan& plan) {
  if (plan.reason.kind == CutoffReason::Kind::kAtRest) return "no low-pass: readings at rest";
  std::string words =
      fmt::format("position low-pass {:.4g} Hz, torque low-pass {:.4g} Hz by {}",
                  plan.position_cutoff_hz, plan.torque_cutoff_hz, words_of(plan.reason));
  if (plan.decimation > 1) words += fmt::format(", one sample of {}", plan.decimation);
  return words + fmt::format(" at {:.6g} Hz", plan.sample_rate_hz);
}

std::string text_of(const Comparisons& comparisons, const CompareNames& names,
                    const Comparisons* against) {
  std::string text;
  const Comparison& first = comparisons.recordings[0];
  if (are_several(comparisons)) {
    text =
        fmt::format("{} recordings against {}\n", comparisons.recordings.size(), names.robot_file) +
        list_of_recordings(comparisons) + words_of_filters(comparisons);
  } else {
    text = fmt::format("{} against {}\n{}, {} samples left\n", names.logs[0], names.robot_file,
                       words_of(first.plan), first.t_s.size());
    for (const std::string& remark : first.remarks) text += "note: " + remark + "\n";
  }
  text += error_table(comparisons);
  if (against != nullptr) {
    text += text_of(before_after(against->joints, comparisons.joints));
    text += "before: " + names.against_file + "\n";
  }
  return text + verdict_of(comparisons, against) + "\n";
}

report::Table before_after_table(const std::vector<NamedErrors>& errors, const FilterPlan& plan) {
  report::Table table;
  table.caption = "Error before and after";
  table.columns = columns_of_error();
  table.columns.insert(table.columns.begin(), report::Column{"data", "", ".4g"});
  for (const NamedErrors& of : errors) {
    for (const BeforeAfter& error : of.joints) {
      table.rows.push_back(cells_of(error));
      table.rows.back().insert(table.rows.back().begin(), of.data);
    }
  }
  table.note = words_of(plan) + ".";
  return table;
}

report::Page page_of(const Comparisons& comparisons, const CompareNames& names,
                     const Comparisons* against) {
  const bool several = are_several(comparisons);
  report::Page page;
  page.title = "Model against measurement";
  page.subtitle = list_of(names.logs) + " against " + names.robot_file;
  page.verdict = {verdict_of(comparisons, against), level_of(comparisons)};
  page.command_line = names.command_line;
  report::Section overview;
  overview.heading = "Error";
  overview.blocks.emplace_back(key_figures(comparisons));
  overview.blocks.emplace_back(table_of(comparisons));
  if (against != nullptr) overview.blocks.emplace_back(fall_table(comparisons, *against, names));
  for (const Comparison& one : comparisons.recordings) {
    for (const std::string& remark : one.remarks) {
      overview.blocks.emplace_back(
          report::Note{several ? one.file + ": " + remark : remark, Level::kWarn});
    }
  }
  page.sections.push_back(std::move(overview));
  for (std::size_t r = 0; r < comparisons.recordings.size(); ++r) {
    const Comparison& one = comparisons.recordings[r];
    for (std::size_t joint = 0; joint < one.joints.size(); ++joint) {
      page.sections.push_back(
          joint_section(one, against != nullptr ? &against->recordings[r] : nullptr, joint));
      if (several) page.sections.back().recording = one.file;
    }
  }
  return page;
}

}  // namespace offnominal::desk
