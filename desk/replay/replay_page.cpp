#include <fmt/format.h>

#include <cstddef>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "replay/replay.hpp"
#include "replay/residual_chart.hpp"

namespace offnominal::desk {
namespace {

using namespace report;  // a page is written in its own words

constexpr std::size_t kMarkedAlarms = 20;

// Values over time, broken where the monitor was blind.
Series line_of(const Replay& replay, const Eigen::Ref<const Eigen::VectorXd>& values) {
  Series line;
  std::size_t next = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    for (; next < replay.blind.size() && replay.blind[next].start_s < replay.t_s[i]; ++next) {
      line.x.push_back(replay.blind[next].start_s);
      line.y.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    line.x.push_back(replay.t_s[i]);
    line.y.push_back(values[i]);
  }
  return line;
}

std::string note_on_blind(const Replay& replay) {
  return replay.blind.empty() ? "" : "The lines are broken where the monitor was blind.";
}

std::vector<EventMark> alarm_marks(const std::optional<double>& detection_time_s) {
  std::vector<EventMark> marks;
  if (detection_time_s) marks.push_back({*detection_time_s, "detected", Level::kBad});
  return marks;
}

// Its detection on its time, which all charts of the page share.
void put_on_time(const Replay& replay, const std::optional<double>& detection_time_s,
                 Chart& chart) {
  chart.note = note_on_blind(replay);
  chart.events = alarm_marks(detection_time_s);
  chart.zoom_group = "time";
}

Chart residual_chart(const Replay& replay) {
  Chart chart = chart_against_threshold(EstimatorSpace::kAcceleration, replay.unit,
                                        line_of(replay, replay.error_norm),
                                        line_of(replay, replay.threshold));
  chart.title = "Residual against its threshold";
  put_on_time(replay, replay.detection_time_s, chart);
  chart.slider = true;
  return chart;
}

// Of one filter.
struct FilterSeries {
  std::string title;
  const Eigen::MatrixXd& error;
  const Eigen::MatrixXd& thresholds;
  double JointReplay::*act_ratio;
};

Chart joint_chart(const Replay& replay, const FilterSeries& filter, Eigen::Index joint) {
  const auto index = static_cast<std::size_t>(joint);
  const JointReplay& of_joint = replay.joints[index];
  Chart chart = chart_against_threshold(
      EstimatorSpace::kTorque, of_joint.unit, line_of(replay, filter.error.col(joint).cwiseAbs()),
      line_of(replay, filter.thresholds.col(joint)), of_joint.*filter.act_ratio);
  chart.title = filter.title + ", " + replay.joint_names[index];
  put_on_time(replay, of_joint.detection_time_s, chart);
  if (replay.has_two_levels && of_joint.act_time_s) {
    chart.events.push_back({*of_joint.act_time_s, "acts", Level::kBad});
  }
  return chart;
}

Table joint_table(const Replay& replay) {
  Table table;
  table.caption = "Joint by joint";
  table.columns = {{"joint", ""},
                   {"first alarm", "s", ".3f"},
                   {"stretches", "1", ".0f"},
                   {"unit", ""},
                   {"largest residual", "", ".4g"},
                   {"largest threshold", "", ".4g"},
                   {"largest ratio", "1", ".3g"}};
  const bool has_fast = replay.fast_error.size() > 0;
  if (has_fast) {
    table.columns.push_back({"behind the fast filter", "", ".4g"});
    table.columns.push_back({"its largest threshold", "", ".4g"});
    table.columns.push_back({"its largest ratio", "1", ".3g"});
  }
  if (replay.has_two_levels) table.columns.push_back({"acts from", "s", ".3f"});
  for (std::size_t i = 0; i < replay.joints.size(); ++i) {
    const JointReplay& joint = replay.joints[i];
    table.rows.push_back({replay.joint_names[i],
                          {},
                          static_cast<double>(joint.alarms.size()),
                          joint.unit,
                          joint.max_residual,
                          joint.max_threshold,
                          joint.max_ratio_slow});
    if (joint.detection_time_s) table.rows.back()[1] = *joint.detection_time_s;
    if (has_fast) {
      table.rows.back().emplace_back(joint.fast_max_residual);
      table.rows.back().emplace_back(joint.fast_max_threshold);
      table.rows.back().emplace_back(joint.max_ratio_fast);
    }
    if (!replay.has_two_levels) continue;
    table.rows.back().emplace_back();
    if (joint.act_time_s) table.rows.back().back() = *joint.act_time_s;
  }
  return table;
}

// One chart of all joints, or one of each where each has its own threshold.
void add_residuals(const Replay& replay, Section& section) {
  if (replay.joints.empty()) {
    section.text =
        "e is the measured velocity minus the estimator's. The monitor is certain that the robot "
        "no "
        "longer behaves as its model and its uncertainty bound say when |e| exceeds mu.";
    section.blocks.emplace_back(residual_chart(replay));
    return;
  }
  section.text =
      "A joint's residual is the torque on it that the model does not explain, behind the "
      "estimator's filter. The monitor is certain that the joint no longer behaves as its model "
      "and "
      "its uncertainty bound say when the residual exceeds the threshold.";
  section.blocks.emplace_back(joint_table(replay));
  const FilterSeries slow{"Residual against its threshold", replay.error, replay.thresholds,
                          &JointReplay::act_ratio};
  const FilterSeries fast{"The same behind the fast filter", replay.fast_error,
                          replay.fast_thresholds, &JointReplay::fast_act_ratio};
  for (Eigen::Index joint = 0; joint < replay.error.cols(); ++joint) {
    Chart chart = joint_chart(replay, slow, joint);
    chart.slider = joint == 0;
    section.blocks.emplace_back(std::move(chart));
    if (fast.error.size() > 0) section.blocks.emplace_back(joint_chart(replay, fast, joint));
  }
}

Chart estimate_chart(const Replay& replay, Eigen::Index joint) {
  const auto index = static_cast<std::size_t>(joint);
  Chart chart;
  chart.title = "Fault estimate psi_hat, " + replay.joint_names[index];
  chart.x = {.name = "time", .unit = "s"};
  const bool in_torque = replay.space == EstimatorSpace::kTorque;
  chart.y = {{.name = in_torque ? "torque" : "acceleration", .unit = replay.psi_hat_units[index]}};
  chart.series = {line_of(replay, replay.psi_hat.col(joint))};
  chart.series[0].name = "psi_hat";
  chart.series[0].tone = Tone::kModel;
  chart.events =
      alarm_marks(in_torque ? replay.joints[index].detection_time_s : replay.detection_time_s);
  chart.zoom_group = "time";
  return chart;
}

Table alarm_table(const Replay& replay) {
  Table table;
  table.caption = "Stretches with the residual above its threshold";
  const bool in_torque = replay.space == EstimatorSpace::kTorque;
  table.columns = {{"from", "s", ".3f"}, {"to", "s", ".3f"}, {ratio_name(replay), "1", ".3g"}};
  if (in_torque) table.columns.push_back({"joints, the first to cross first", ""});
  for (const Alarm& alarm : replay.alarms) {
    if (table.rows.size() == kMarkedAlarms) {
      table.note = fmt::format("The first {} of {}; `offnominal replay --json` has them all.",
                               kMarkedAlarms, replay.alarms.size());
      break;
    }
    table.rows.push_back({alarm.start_s, alarm.end_s, alarm.max_error_to_threshold});
    if (in_torque) table.rows.back().emplace_back(joints_of(replay, alarm));
  }
  return table;
}

Table fault_table(const Replay& replay) {
  Table table;
  table.caption = "Which fault it is";
  table.columns = {{"detected", "s", ".3f"},
                   {"answer", ""},
                   {"said", "s", ".3f"},
                   {"confidence", "1", ".2f"},
                   {"unexplained", "1", ".2f"}};
  for (const IsolatedFault& fault : replay.faults) {
    table.rows.push_back({fault.detection_time_s, words_of(fault, replay.joint_names), fault.time_s,
                          fault.confidence, fault.unexplained});
  }
  return table;
}

Table blind_table(const Replay& replay) {
  Table table;
  table.caption = fmt::format("Blind for {:.3f} s: what was here nobody saw", replay.blind_s());
  table.columns = {{"from", "s", ".3f"}, {"to", "s", ".3f"}, {"samples refused", "1", "d"}};
  for (const BlindStretch& one : replay.blind) {
    if (table.rows.size() == kMarkedAlarms) {
      table.note = fmt::format("The first {} of {}; `offnominal replay --json` has them all.",
                               kMarkedAlarms, replay.blind.size());
      break;
    }
    table.rows.push_back({one.start_s, one.end_s, static_cast<double>(one.samples)});
  }
  return table;
}

// Nothing is good that nobody saw.
Level level_of(const Replay& replay) {
  if (replay.detection_time_s) return Level::kBad;
  return replay.is_blind() || replay.is_too_short() ? Level::kWarn : Level::kGood;
}

KeyFigures key_figures(const Replay& replay) {
  KeyFigures figures;
  KeyFigure detected{.label = "first alarm", .unit = "s", .format = ".3f"};
  if (replay.detection_time_s) {
    detected.value = *replay.detection_time_s;
  } else {
    detected.value = std::string("none");
    detected.unit = "";
  }
  detected.level = level_of(replay);
  figures.figures = {
      detected,
      {.label = ratio_name(replay),
       .value = replay.max_error_to_threshold,
       .unit = "1",
       .format = ".3g"},
      {.label = "samples judged",
       .value = fmt::format("{} of {}", replay.judged(), replay.samples()),
       .unit = "",
       .level = replay.is_blind() ? Level::kWarn : Level::kNeutral,
       .note = replay.blind.empty() ? "" : fmt::format("blind for {:.3f} s", replay.blind_s())},
      {.label = "tick", .value = 1000 * replay.period_s, .unit = "ms"}};
  return figures;
}

}  // namespace

report::Page page_of(const Replay& replay, const std::string& command_line) {
  Page page;
  page.title = "Replay of " + replay.log;
  page.subtitle = "on-board monitor of robot " + replay.robot;
  page.verdict = {words_of(replay), level_of(replay)};
  page.command_line = command_line;
  Section residual{.heading = "Residual", .text = "", .blocks = {}};
  residual.blocks.emplace_back(key_figures(replay));
  add_residuals(replay, residual);
  if (!replay.faults.empty()) residual.blocks.emplace_back(fault_table(replay));
  if (!replay.alarms.empty()) residual.blocks.emplace_back(alarm_table(replay));
  if (!replay.blind.empty()) residual.blocks.emplace_back(blind_table(replay));
  page.sections.push_back(residual);
  Section estimate{.heading = "What changed", .text = "", .blocks = {}};
  estimate.text =
      replay.space == EstimatorSpace::kTorque
          ? "The network's estimate of the torque that the model does not explain; on each joint "
            "exactly zero until its first alarm."
          : "The network's estimate of the acceleration that the model does not explain; exactly "
            "zero until the first alarm.";
  if (!replay.blind.empty()) estimate.text += " Behind a blind stretch it begins at zero again.";
  for (Eigen::Index joint = 0; joint < replay.psi_hat.cols(); ++joint) {
    estimate.blocks.emplace_back(estimate_chart(replay, joint));
  }
  page.sections.push_back(estimate);
  return page;
}

}  // namespace offnominal::desk
