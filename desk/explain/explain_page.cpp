#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "common/effort_name.hpp"
#include "common/nearest.hpp"
#include "common/plain_words.hpp"
#include "compare/error_map.hpp"
#include "explain/data_fault_report.hpp"
#include "explain/doubts.hpp"
#include "explain/explain_report.hpp"
#include "report/numbers.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using report::Level;
using report::numbers;

const JointErrors& joint_of(const Explanation& e, Index joint) {
  return e.joints[static_cast<std::size_t>(joint)];
}

const char* position_unit(const JointErrors& joint) { return joint.unit == "N" ? "m" : "rad"; }
const char* velocity_unit(const JointErrors& joint) { return joint.unit == "N" ? "m/s" : "rad/s"; }

report::Table error_table(const Explanation& e) {
  const auto forces = std::count_if(e.joints.begin(), e.joints.end(), [](const JointErrors& one) {
    return effort_name(one.unit) == effort_name("N");
  });
  const bool all = forces == static_cast<std::ptrdiff_t>(e.joints.size());
  const char* effort = all ? "force" : forces == 0 ? "torque" : "torque or force";
  report::Table table;
  table.caption = fmt::format("Error of each joint's {}, root mean square", effort);
  table.columns = {{"joint", "", "d"},
                   {"unit", "", ".4g"},
                   {effort, "", ".4g"},
                   {"error before", "", ".4g"},
                   {"error after", "", ".4g"},
                   {"noise floor", "", ".4g"},
                   {"held out, before", "", ".4g"},
                   {"held out, after", "", ".4g"},
                   {"held out, noise floor", "", ".4g"}};
  for (const JointErrors& joint : e.joints) {
    table.rows.push_back({static_cast<double>(joint.joint + 1), joint.unit, joint.rms_torque,
                          joint.rms_before, joint.rms_improved, joint.noise_floor,
                          joint.holdout_before, joint.holdout_after, joint.holdout_noise_floor});
  }
  table.note = e.holdout_is_apart ? "Held out: recordings that no fit has seen."
               : e.at_rest
                   ? "Held out: stretches of readings, each predicted by a fit of the others."
                   : "Held out: contiguous blocks of time, each predicted by a fit of the others.";
  if (!e.hold_friction.empty()) {
    table.note += " Fitted beside, and never written: friction by the direction of approach,";
    for (const HoldFriction& one : e.hold_friction) {
      table.note += fmt::format(" {:.4g} {} at joint {}", one.level, one.unit, one.joint + 1);
    }
    table.note += ".";
  }
  return table;
}

report::Table answer_table(const Explanation& e) {
  report::Table table;
  table.caption = "Every joint's answer";
  table.columns = {
      {"joint", "", "d"},     {"verdict", "", ".4g"},        {"left", "", ".3g"},
      {"unit", "", ".4g"},    {"of the torque", "%", ".2g"}, {"times the noise", "", ".1f"},
      {"in words", "", ".4g"}};
  for (const JointAnswer& one : e.answers) {
    table.rows.push_back({static_cast<double>(one.joint + 1), std::string(name_of(one.verdict)),
                          one.left.rms, joint_of(e, one.joint).unit, 100 * one.left.share_of_torque,
                          one.left.times_noise, one.words});
  }
  table.note = "The joint whose model lacked the largest share of its torque stands first.";
  return table;
}

report::Table finding_table(const Explanation& e) {
  report::Table table;
  table.caption = "Effects found";
  table.columns = {{"effect", "", ".4g"}, {"joint", "", "d"},       {"parameter", "", ".4g"},
                   {"value", "", ".5g"},  {"95 % from", "", ".5g"}, {"to", "", ".5g"},
                   {"unit", "", ".4g"},   {"p", "", ".2g"},         {"p by replay", "", ".2g"}};
  for (const Finding& finding : e.found) {
    for (const Estimate& one : finding.parameters) {
      report::Cell low;
      report::Cell high;
      if (one.ci95) {
        low = (*one.ci95)[0];
        high = (*one.ci95)[1];
      } else {
        table.note += fmt::format("{}{} of joint {}, {}: {}.", table.note.empty() ? "" : " ",
                                  title_of(finding), finding.what.joint + 1, one.value.name,
                                  one.why_no_interval);
      }
      table.rows.push_back({title_of(finding), static_cast<double>(finding.what.joint + 1),
                            one.value.name, one.value.value, low, high, one.value.unit,
                            finding.p_value, finding.p_replay});
    }
  }
  return table;
}

std::string words_of_recordings(const ExplainNames& names) {
  if (names.after.empty()) return list_of(names.logs);
  const std::vector<std::string> before(
      names.logs.begin(), names.logs.end() - static_cast<std::ptrdiff_t>(names.after.size()));
  return list_of(before) + " before, " + list_of(names.after) + " after,";
}

report::Table change_table(const Explanation& e) {
  report::Table table;
  table.caption = e.changes_between ? "What changes from the recordings before to those after"
                                    : "What changes in the middle of a recording";
  table.columns = {{"effect", "", ".4g"},     {"joint", "", "d"},        {"recording", "", "d"},
                   {"at", "s", ".2f"},        {"95 % from", "s", ".2f"}, {"to", "s", ".2f"},
                   {"gone at", "s", ".2f"},   {"parameter", "", ".4g"},  {"changes by", "", ".3g"},
                   {"95 % from ", "", ".3g"}, {"to ", "", ".3g"},        {"unit", "", ".4g"},
                   {"p", "", ".2g"}};
  for (const Change& one : e.changes) {
    std::string name(one.what.name());
    for (const EffectAt& other : one.alike) {
      name += fmt::format(" or {} of joint {}", other.name(), other.joint + 1);
    }
    for (const Estimate& by : one.by) {
      report::Cell low;
      report::Cell high;
      report::Cell at;
      report::Cell earliest;
      report::Cell latest;
      report::Cell gone;
      if (!one.is_between) at = one.at_s;
      if (one.at_ci95_s) {
        earliest = (*one.at_ci95_s)[0];
        latest = (*one.at_ci95_s)[1];
      }
      if (one.until_s) gone = *one.until_s;
      if (by.ci95) {
        low = (*by.ci95)[0];
        high = (*by.ci95)[1];
      }
      table.rows.push_back({name, static_cast<double>(one.what.joint + 1),
                            static_cast<double>(one.recording + 1), at, earliest, latest, gone,
                            by.value.name, by.value.value, low, high, by.value.unit, one.p_value});
    }
  }
  table.note =
      e.changes_between
          ? "There in the recordings after, and not in those before; a minus sign: the "
            "other way round."
          : "There from that moment on, or until it is gone, and not before; a minus sign: "
            "there until then.";
  return table;
}

report::Table push_table(const Explanation& e) {
  report::Table table;
  table.caption = "What acts on the arm from outside";
  table.columns = {{"recording", "", ".4g"}, {"from", "s", ".2f"},      {"to", "s", ".2f"},
                   {"joint", "", "d"},       {"rms torque", "", ".3g"}, {"unit", "", ".4g"}};
  for (const Push& one : e.pushes) {
    for (const Push::OnJoint& on : one.joints) {
      table.rows.push_back({one.file, one.from_s, one.to_s, static_cast<double>(on.joint + 1),
                            on.rms_torque, on.unit});
    }
  }
  table.note = "Left out of all else that is said here.";
  return table;
}

report::Table where_table(const Explanation& e) {
  constexpr std::size_t kMost = 8;
  report::Table table;
  table.caption = "What the remaining error follows";
  table.columns = {{"joint", "", "d"}, {"variable", "", ".4g"}, {"share", "%", ".1f"}};
  for (std::size_t i = 0; i < std::min(kMost, e.where.size()); ++i) {
    table.rows.push_back(
        {static_cast<double>(e.where[i].joint + 1), e.where[i].variable, 100 * e.where[i].share});
  }
  table.note =
      "Share of the error's energy on stretches of time that the smooth fit has not seen; "
      "for time: concentrated in a tenth of it.";
  return table;
}

report::Table class_table(const Explanation& e) {
  report::Table table;
  table.caption = "What these recordings cannot tell apart";
  table.columns = {{"class", "", "d"}, {"effect", "", ".4g"}, {"joint", "", "d"}};
  for (std::size_t i = 0; i < e.ambiguous.size(); ++i) {
    for (const EffectAt& one : e.ambiguous[i]) {
      table.rows.push_back({static_cast<double>(i + 1), std::string(one.name()),
                            static_cast<double>(one.joint + 1)});
    }
    if (may_be_own_numbers(e, e.ambiguous[i])) {
      table.rows.push_back({static_cast<double>(i + 1), kOwnNumbers, {}});
    }
  }
  table.note = "One of each class is what shows, the likeliest effect stands first.";
  return table;
}

report::Table rejected_table(const Explanation& e) {
  report::Table table;
  table.caption = "Effects that these recordings do not show";
  table.columns = {{"effect", "", ".4g"},
                   {"joint", "", "d"},
                   {"p", "", ".2g"},
                   {"smallest that would have been seen", "", ".3g"},
                   {"unit", "", ".4g"}};
  for (const Rejection& one : e.rejected) {
    table.rows.push_back({std::string(one.what.name()), static_cast<double>(one.what.joint + 1),
                          one.p_value, one.smallest_detectable, one.unit});
  }
  return table;
}

report::Waterfall waterfall_of(const Explanation& e, Index joint) {
  report::Waterfall waterfall;
  const JointErrors& errors = joint_of(e, joint);
  waterfall.title =
      fmt::format("Held-out error of joint {} in the search, effect by effect", joint + 1);
  waterfall.value_axis = {fmt::format("rms {} error", effort_name(errors.unit)), errors.unit};
  // Of other joints' effects only those that show on this one.
  constexpr double kShows = 0.01;
  for (std::size_t i = 0; i < e.waterfall.size(); ++i) {
    const double error = e.waterfall[i][joint];
    if (i == 0) {
      waterfall.steps.push_back({"the file's numbers fitted", error});
      continue;
    }
    const Finding& added = e.found[i - 1];
    const bool elsewhere = added.what.joint != joint;
    const double before = e.waterfall[i - 1][joint];
    if (elsewhere && std::abs(error - before) <= kShows * before) continue;
    waterfall.steps.push_back(
        {elsewhere ? fmt::format("+ {} on joint {}", title_of(added), added.what.joint + 1)
                   : "+ " + title_of(added),
         error});
  }
  waterfall.levels.push_back({errors.holdout_noise_floor, "noise floor"});
  waterfall.width = report::Width::kHalf;
  return waterfall;
}

report::Series series_of(const char* name, const VectorXd& x, const VectorXd& y, report::Tone tone,
                         report::SeriesKind kind) {
  report::Series series;
  series.name = name;
  series.kind = kind;
  series.x = numbers(x);
  series.y = numbers(y);
  series.tone = tone;
  return series;
}

// One recording of an explanation.
struct Pictured {
  const Explanation& whole;
  const Explanation::Series& series;
  bool alone = true;  // it is the only one

  [[nodiscard]] const JointErrors& errors(Index joint) const { return joint_of(whole, joint); }
};

bool has_waterfall(const Explanation& e) {
  return !e.waterfall.empty() && e.waterfall.size() == e.found.size() + 1;
}

// Measured and model torque over x, of as many values as the recording.
std::vector<report::Series> torques(const Pictured& e, Index joint, const VectorXd& x,
                                    report::SeriesKind kind) {
  return {series_of("measured", x, e.series.measured.col(joint), report::Tone::kMeasured, kind),
          series_of("model with what was found", x, e.series.model_after.col(joint),
                    report::Tone::kModel, kind)};
}

// Measured torque less the model's over x, before and after.
std::vector<report::Series> torque_errors(const Pictured& e, Index joint, const VectorXd& x,
                                          report::SeriesKind kind) {
  const VectorXd measured = e.series.measured.col(joint);
  return {series_of("model as it is", x, measured - e.series.model_before.col(joint),
                    report::Tone::kFaint, kind),
          series_of("with what was found", x, measured - e.series.model_after.col(joint),
                    report::Tone::kResidual, kind)};
}

report::Chart torque_chart(const Pictured& e, Index joint) {
  const JointErrors& errors = e.errors(joint);
  report::Chart chart;
  chart.title = fmt::format("{} of joint {}", capitalised(effort_name(errors.unit)), joint + 1);
  chart.x = {"time", "s"};
  chart.y = {{effort_name(errors.unit), errors.unit}};
  chart.series = torques(e, joint, e.series.t_s, report::SeriesKind::kLine);
  chart.zoom_group = "time";
  chart.slider = true;
  return chart;
}

report::Chart residual_chart(const Pictured& e, Index joint) {
  const JointErrors& errors = e.errors(joint);
  report::Chart chart;
  chart.title =
      fmt::format("{} error of joint {}", capitalised(effort_name(errors.unit)), joint + 1);
  chart.x = {"time", "s"};
  chart.y = {{"measured less model", errors.unit}};
  chart.series = torque_errors(e, joint, e.series.t_s, report::SeriesKind::kLine);
  chart.zoom_group = "time";
  return chart;
}

// Mean error of the model as it is over two variables.
report::Heatmap error_map(const Pictured& e, Index joint) {
  const JointErrors& errors = e.errors(joint);
  return mean_map(fmt::format("Mean error of joint {}, model as it is", joint + 1),
                  {{"position", position_unit(errors)}, e.series.q.col(joint)},
                  {{"velocity", velocity_unit(errors)}, e.series.dq.col(joint)},
                  {{fmt::format("{} error", effort_name(errors.unit)), errors.unit},
                   e.series.measured.col(joint) - e.series.model_before.col(joint)});
}

// The error over one variable, before and after.
report::Chart error_over(const Pictured& e, Index joint, const char* variable, const char* unit,
                         const VectorXd& values) {
  const JointErrors& errors = e.errors(joint);
  report::Chart chart;
  chart.title = fmt::format("Error of joint {} over {}", joint + 1, variable);
  chart.x = {variable, unit};
  chart.y = {{"measured less model", errors.unit}};
  chart.series = torque_errors(e, joint, values, report::SeriesKind::kPoints);
  chart.width = report::Width::kHalf;
  return chart;
}

// Measured and model torque over the position, of readings at rest.
report::Chart torque_over_position(const Pictured& e, Index joint) {
  const JointErrors& errors = e.errors(joint);
  report::Chart chart;
  chart.title =
      fmt::format("{} of joint {} over position", capitalised(effort_name(errors.unit)), joint + 1);
  chart.x = {"position", position_unit(errors)};
  chart.y = {{effort_name(errors.unit), errors.unit}};
  chart.series = torques(e, joint, e.series.q.col(joint), report::SeriesKind::kPoints);
  chart.zoom_group = "position";
  return chart;
}

report::Section joint_section(const Pictured& e, Index joint) {
  const JointErrors& errors = e.errors(joint);
  report::Section section;
  section.heading = fmt::format("Joint {}", joint + 1);
  if (e.alone && has_waterfall(e.whole)) {
    section.blocks.emplace_back(waterfall_of(e.whole, joint));
  }
  if (e.whole.at_rest) {
    section.blocks.emplace_back(torque_over_position(e, joint));
    section.blocks.emplace_back(
        error_over(e, joint, "position", position_unit(errors), e.series.q.col(joint)));
    return section;
  }
  section.blocks.emplace_back(error_map(e, joint));
  section.blocks.emplace_back(torque_chart(e, joint));
  section.blocks.emplace_back(residual_chart(e, joint));
  section.blocks.emplace_back(
      error_over(e, joint, "velocity", velocity_unit(errors), e.series.dq.col(joint)));
  section.blocks.emplace_back(
      error_over(e, joint, "position", position_unit(errors), e.series.q.col(joint)));
  section.blocks.emplace_back(
      error_over(e, joint, "load", errors.unit.c_str(), e.series.load.col(joint)));
  return section;
}

// Of all recordings together.
report::Section waterfalls(const Explanation& e) {
  report::Section section;
  section.heading = "Effect by effect";
  for (Index joint = 0; joint < static_cast<Index>(e.joints.size()); ++joint) {
    section.blocks.emplace_back(waterfall_of(e, joint));
  }
  return section;
}

}  // namespace

report::Page page_of(const Explanation& e, const ExplainNames& names) {
  report::Page page;
  page.title = "What the model lacks";
  page.subtitle = words_of_recordings(names) + " against " + names.robot_file;
  page.verdict = {std::string(name_of(e.verdict)) + ": " + e.words, level_of(e.verdict)};
  page.command_line = names.command_line;
  report::Section overview;
  overview.heading = "Evidence";
  for (const DataFault& fault : e.data_faults) {
    overview.blocks.emplace_back(report::Note{fault.words + ". " + fault.mend, Level::kBad});
  }
  if (!e.left_out.empty()) overview.blocks.emplace_back(table_of_left_out(e.left_out));
  if (!e.answers.empty()) overview.blocks.emplace_back(answer_table(e));
  if (!e.found.empty()) overview.blocks.emplace_back(finding_table(e));
  if (!e.pushes.empty()) overview.blocks.emplace_back(push_table(e));
  if (!e.changes.empty()) overview.blocks.emplace_back(change_table(e));
  if (!e.ambiguous.empty()) overview.blocks.emplace_back(class_table(e));
  overview.blocks.emplace_back(error_table(e));
  if (!e.where.empty()) overview.blocks.emplace_back(where_table(e));
  for (const std::string& advice : e.advice) {
    overview.blocks.emplace_back(report::Note{advice, Level::kNeutral});
  }
  for (const std::string& doubt : doubts_of(e)) {
    overview.blocks.emplace_back(report::Note{"Doubt: " + doubt + ".", Level::kBad});
  }
  page.sections.push_back(std::move(overview));
  const bool alone = e.series.size() == 1;
  if (!alone && has_waterfall(e)) page.sections.push_back(waterfalls(e));
  for (const Explanation::Series& series : e.series) {
    const Pictured pictured{e, series, alone};
    for (Index joint = 0; joint < static_cast<Index>(e.joints.size()); ++joint) {
      page.sections.push_back(joint_section(pictured, joint));
      if (!alone) page.sections.back().recording = series.name;
    }
  }
  report::Section rejected;
  rejected.heading = "What these recordings do not show";
  rejected.blocks.emplace_back(rejected_table(e));
  page.sections.push_back(std::move(rejected));
  return page;
}

}  // namespace offnominal::desk
