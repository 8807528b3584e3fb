#include "compare/compare_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/effort_name.hpp"
#include "common/text_table.hpp"
#include "compare/before_after.hpp"
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
  if (joint.left_out >= kWorthMention) {
    words += fmt::format(
        " {:.0f} % of the samples do not count: the joint stands still there, and friction may "
        "hold "
        "it.",
        100 * joint.left_out);
  }
  return words;
}

Level level_of(const JointComparison& joint) {
  if (joint.relative_error_percent <= kGoodPercent) return Level::kGood;
  return joint.relative_error_percent <= kPoorPercent ? Level::kWarn : Level::kBad;
}

report::KeyFigures key_figures(const Comparison& comparison) {
  report::KeyFigures keys;
  for (const JointComparison& joint : comparison.joints) {
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

report::Table table_of(const Comparison& comparison) {
  report::Table table;
  table.caption = "Error per joint";
  table.columns = {{"joint", "", "d"},  {"rms error", "", ".4g"},       {"rms torque", "", ".4g"},
                   {"unit", "", ".4g"}, {"relative error", "%", ".2f"}, {"fit", "%", ".2f"}};
  for (const JointComparison& joint : comparison.joints) {
    table.rows.push_back({static_cast<double>(joint.joint + 1), joint.rms_error, joint.rms_torque,
                          joint.unit, joint.relative_error_percent, joint.fit_percent});
  }
  table.note =
      "Relative error: 100 |tau - tau_m| / |tau|. Fit: 100 (1 - |tau - tau_m| / |tau - mean|). "
      "Both over the filtered samples: " +
      words_of(comparison.plan) + ".";
  return table;
}

report::Table fall_table(const Comparison& comparison, const Comparison& against,
                         const CompareNames& names) {
  report::Table table;
  table.caption = "Fall of the error";
  table.columns = {
      {"joint", "", "d"},  {"rms before", "", ".4g"},       {"rms after", "", ".4g"},
      {"unit", "", ".4g"}, {"relative before", "%", ".2f"}, {"relative after", "%", ".2f"},
      {"fall", "%", ".1f"}};
  for (const BeforeAfter& error : before_after(against, comparison)) {
    table.rows.push_back({static_cast<double>(error.joint + 1), error.before_rms, error.after_rms,
                          error.unit, error.before_percent, error.after_percent,
                          100 * error.fall()});
  }
  table.note = "Before: " + names.against_file + ". Fall of the rms error; negative: it has grown.";
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
  for (const MotionVariable variable :
       {MotionVariable::kVelocity, MotionVariable::kPosition, MotionVariable::kAcceleration}) {
    section.blocks.emplace_back(residual_over(models, joint, variable));
  }
  return section;
}

}  // namespace

std::string verdict_of(const Comparison& comparison, const Comparison* against) {
  std::string words;
  if (against != nullptr) {
    for (const BeforeAfter& error : before_after(*against, comparison)) {
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

Level level_of(const Comparison& comparison) {
  Level worst = Level::kGood;
  for (const JointComparison& joint : comparison.joints) worst = std::max(worst, level_of(joint));
  return worst;
}

nlohmann::ordered_json to_json(const FilterPlan& plan) {
  return {{"sample_rate_hz", plan.sample_rate_hz},
          {"position_cutoff_hz", plan.position_cutoff_hz},
          {"torque_cutoff_hz", plan.torque_cutoff_hz},
          {"decimation", plan.decimation}};
}

nlohmann::ordered_json to_json(const Comparison& comparison, const CompareNames& names,
                               const Comparison* against) {
  nlohmann::ordered_json json;
  json["log"] = names.log;
  json["robot"] = names.robot_file;
  json["joints"] = nlohmann::ordered_json::array();
  json["where"] = nlohmann::ordered_json::array();
  for (const JointComparison& joint : comparison.joints) {
    json["joints"].push_back({{"joint", joint.joint + 1},
                              {"unit", joint.unit},
                              {"rms_error", joint.rms_error},
                              {"rms_torque", joint.rms_torque},
                              {"relative_error_percent", joint.relative_error_percent},
                              {"fit_percent", joint.fit_percent},
                              {"left_out_percent", 100 * joint.left_out}});
    if (joint.gear) {
      json["joints"].back()["gear"] = {{"rms", joint.gear->rms},
                                       {"percent_of_drive", joint.gear->percent},
                                       {"follows", joint.gear->follows.variable},
                                       {"share", joint.gear->follows.share}};
    }
    for (const ErrorShare& where : joint.where) {
      json["where"].push_back({{"joint", joint.joint + 1},
                               {"variable", where.variable},
                               {"share_of_residual", where.share}});
    }
  }
  json["samples"] = comparison.t_s.size();
  json["filter"] = to_json(comparison.plan);
  json["remarks"] = comparison.remarks;
  json["verdict"] = verdict_of(comparison, against);
  if (against == nullptr) return json;
  json["against"] = {{"robot", names.against_file}, {"joints", nlohmann::ordered_json::array()}};
  for (const BeforeAfter& error : before_after(*against, comparison)) {
    json["against"]["joints"].push_back({{"joint", error.joint + 1},
                                         {"unit", error.unit},
                                         {"rms_error", error.before_rms},
                                         {"relative_error_percent", error.before_percent},
                                         {"fall_percent", 100 * error.fall()}});
  }
  return json;
}

std::string words_of(const FilterPlan& plan) {
  std::string words = fmt::format("position low-pass {:.4g} Hz, torque low-pass {:.4g} Hz",
                                  plan.position_cutoff_hz, plan.torque_cutoff_hz);
  if (plan.decimation > 1) words += fmt::format(", one sample of {}", plan.decimation);
  return words + fmt::format(" at {:.6g} Hz", plan.sample_rate_hz);
}

std::string text_of(const Comparison& comparison, const CompareNames& names,
                    const Comparison* against) {
  std::string text =
      fmt::format("{} against {}\n{}, {} samples left\n", names.log, names.robot_file,
                  words_of(comparison.plan), comparison.t_s.size());
  for (const std::string& remark : comparison.remarks) text += "note: " + remark + "\n";
  const TextTable table(
      {{"joint", -6}, {"rms error", 14}, {"rms torque", 14}, {"relative error", 15}, {"fit", 10}});
  text += table.heading();
  for (const JointComparison& joint : comparison.joints) {
    text += table.row(joint.joint + 1, fmt::format("{:.4g} {}", joint.rms_error, joint.unit),
                      fmt::format("{:.4g} {}", joint.rms_torque, joint.unit),
                      percent(joint.relative_error_percent), percent(joint.fit_percent));
  }
  if (against != nullptr) {
    text += text_of(before_after(*against, comparison));
    text += "before: " + names.against_file + "\n";
  }
  return text + verdict_of(comparison, against) + "\n";
}

report::Page page_of(const Comparison& comparison, const CompareNames& names,
                     const Comparison* against) {
  report::Page page;
  page.title = "Model against measurement";
  page.subtitle = names.log + " against " + names.robot_file;
  page.verdict = {verdict_of(comparison, against), level_of(comparison)};
  page.command_line = names.command_line;
  report::Section overview;
  overview.heading = "Error";
  overview.blocks.emplace_back(key_figures(comparison));
  overview.blocks.emplace_back(table_of(comparison));
  if (against != nullptr) overview.blocks.emplace_back(fall_table(comparison, *against, names));
  for (const std::string& remark : comparison.remarks) {
    overview.blocks.emplace_back(report::Note{remark, Level::kWarn});
  }
  page.sections.push_back(std::move(overview));
  for (std::size_t joint = 0; joint < comparison.joints.size(); ++joint) {
    page.sections.push_back(joint_section(comparison, against, joint));
  }
  return page;
}

}  // namespace offnominal::desk
