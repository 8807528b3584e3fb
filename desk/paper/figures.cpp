#include "paper/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/plain_words.hpp"
#include "report/act_level.hpp"

namespace offnominal::desk::paper {
namespace {

using report::Chart;
using report::Level;
using report::Series;
using report::Tone;

const std::string kZoomGroup = "time";

// A chart that is no figure of the paper has number 0.
std::string titled(int number, std::string title) {
  if (number > 0) return fmt::format("Figure {}: {}", number, title);
  return capitalised(std::move(title));
}

std::vector<report::EventMark> events_of(const ExperimentResult& run) {
  std::vector<report::EventMark> events;
  if (run.fault_time_s) events.push_back({*run.fault_time_s, "fault", Level::kNeutral});
  if (run.detection_time_s) events.push_back({*run.detection_time_s, "detected", Level::kGood});
  if (run.has_two_levels && run.act_time_s)
    events.push_back({*run.act_time_s, "acts", Level::kBad});
  if (run.slowed_time_s) events.push_back({*run.slowed_time_s, "slowed", Level::kWarn});
  return events;
}

Series line(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
            Tone tone, bool dashed = false) {
  Series series;
  series.name = name;
  series.x = x;
  series.y = y;
  series.tone = tone;
  series.dashed = dashed;
  return series;
}

Chart time_chart(const ExperimentResult& run, const std::string& title, report::Axis y) {
  Chart chart;
  chart.title = title;
  chart.x.name = "time";
  chart.x.unit = "s";
  chart.y = {std::move(y)};
  chart.events = events_of(run);
  chart.zoom_group = kZoomGroup;
  chart.max_points = 2000;  // seventeen charts on a page
  return chart;
}

report::Axis axis(const std::string& name, const std::string& unit) {
  report::Axis result;
  result.name = name;
  result.unit = unit;
  return result;
}

void add_joint_angles(report::Section& section, const ExperimentResult& run, int number) {
  for (std::size_t i = 0; i < run.series.q.size(); ++i) {
    Chart chart = time_chart(run, titled(number, fmt::format("angle of joint {}", i + 1)),
                             axis("angle", "rad"));
    chart.series = {
        line("actual", run.series.time_s, run.series.q[i], Tone::kMeasured),
        line("desired", run.series.time_s, run.series.q_desired[i], Tone::kModel, true)};
    chart.width = report::Width::kHalf;
    section.blocks.emplace_back(std::move(chart));
  }
}

void add_fault_functions(report::Section& section, const ExperimentResult& run, int number) {
  for (std::size_t i = 0; i < run.series.q.size(); ++i) {
    Chart chart = time_chart(
        run, titled(number, fmt::format("fault and network output, joint {}", i + 1)),
        run.joints.empty() ? axis("acceleration", "rad/s^2") : axis("torque", run.joints[i].unit));
    chart.series = {line("fault function", run.series.time_s, run.series.psi[i], Tone::kMeasured),
                    line("network output", run.series.time_s, run.series.psi_hat[i], Tone::kModel)};
    chart.width = report::Width::kHalf;
    section.blocks.emplace_back(std::move(chart));
  }
}

void add_filtered_sizes(report::Section& section, const ExperimentResult& run, int number) {
  Chart chart =
      time_chart(run, titled(number, "filtered size of the uncertainty bound and of the fault"),
                 axis("filtered size", "rad/s"));
  const TimeSeries& series = run.series;
  chart.series = {
      line("uncertainty bound (threshold mu)", series.time_s, series.threshold, Tone::kThreshold),
      line("fault (|eta|)", series.time_s, series.filtered_fault, Tone::kMeasured),
      line("estimation error |e|", series.time_s, series.error_norm, Tone::kResidual)};
  chart.slider = true;
  chart.note =
      "A fault is declared when |e| exceeds mu. It is certain to be declared once |eta| "
      "exceeds twice mu, whatever the uncertainty within its bound does (Theorem 4.2).";
  section.blocks.emplace_back(std::move(chart));
}

// Of a joint, behind a second filter, which sees sooner what is short and large.
Chart fast_residual_chart(const ExperimentResult& run, std::size_t i) {
  const TimeSeries& series = run.series;
  const JointRun& joint = run.joints[i];
  Chart chart = time_chart(
      run, fmt::format("The same behind the fast filter, joint {}, {}", i + 1, joint.name),
      axis("residual", joint.unit));
  chart.series = {
      line("threshold", series.time_s, series.joint_fast_threshold[i], Tone::kThreshold),
      line("residual", series.time_s, series.joint_fast_residual[i], Tone::kResidual)};
  if (joint.fast_act_ratio > 1) {
    chart.series.push_back(report::act_level(chart.series.front(), joint.fast_act_ratio));
  }
  chart.width = report::Width::kHalf;
  return chart;
}

// Of a monitor that judges joint by joint.
void add_joint_residuals(report::Section& section, const ExperimentResult& run) {
  const TimeSeries& series = run.series;
  for (std::size_t i = 0; i < run.joints.size(); ++i) {
    const JointRun& joint = run.joints[i];
    Chart chart =
        time_chart(run, fmt::format("Residual and threshold of joint {}, {}", i + 1, joint.name),
                   axis("residual", joint.unit));
    chart.series = {line("threshold", series.time_s, series.joint_threshold[i], Tone::kThreshold),
                    line("fault, filtered", series.time_s, series.joint_fault[i], Tone::kMeasured),
                    line("residual", series.time_s, series.joint_residual[i], Tone::kResidual)};
    if (joint.act_ratio > 1) {
      chart.series.push_back(report::act_level(chart.series.front(), joint.act_ratio));
    }
    chart.width = report::Width::kHalf;
    if (i == 0) {
      chart.note =
          "A joint is called off nominal when its residual exceeds its threshold. It is certain to "
          "be once its filtered fault exceeds twice the threshold.";
    }
    section.blocks.emplace_back(std::move(chart));
    if (!series.joint_fast_residual.empty()) {
      section.blocks.emplace_back(fast_residual_chart(run, i));
    }
  }
}

report::Section fault_section(const std::string& heading, const ExperimentResult& run,
                              int first_figure) {
  report::Section section;
  section.heading = heading;
  section.text = words_of(run);
  add_joint_angles(section, run, first_figure);
  add_fault_functions(section, run, first_figure > 0 ? first_figure + 1 : 0);
  if (run.joints.empty()) {
    add_filtered_sizes(section, run, first_figure > 0 ? first_figure + 2 : 0);
  } else {
    add_joint_residuals(section, run);
  }
  return section;
}

report::Section accommodation_section(const PaperRuns& runs) {
  report::Section section;
  section.heading = "Accommodation";
  section.text =
      words_of(runs.mass_loss_accommodated) + "\n\n" + words_of(runs.nonlinear_accommodated);
  add_joint_angles(section, runs.mass_loss_accommodated, 14);
  add_joint_angles(section, runs.nonlinear_accommodated, 15);
  return section;
}

report::Section sweep_section(const SweepResult& sweep) {
  report::Section section;
  section.heading = "Smallest mass loss that is detected";
  section.text = sweep.smallest_detected
                     ? fmt::format(
                           "Of all losses in steps of {:g} %, {:.1f} % is the smallest that "
                           "is detected. The paper says 10 %.",
                           100.0 * sweep.resolution, 100.0 * *sweep.smallest_detected)
                     : "No loss was detected.";
  Chart chart;
  chart.title = "Time of detection over the loss of mass";
  chart.x = axis("loss of mass 1", "%");
  chart.y = {axis("time of detection", "s")};
  Series detected = line("detected", {}, {}, Tone::kMeasured);
  detected.kind = report::SeriesKind::kPoints;
  for (const SweepProbe& probe : sweep.probes) {
    if (!probe.detection_time_s) continue;
    detected.x.push_back(100.0 * probe.mass_loss);
    detected.y.push_back(*probe.detection_time_s);
  }
  if (detected.x.empty()) return section;
  chart.x.min = 0.0;
  if (sweep.largest_undetected) {
    chart.events.push_back({100.0 * *sweep.largest_undetected, "largest undetected", Level::kWarn});
  }
  chart.series = {std::move(detected)};
  section.blocks.emplace_back(std::move(chart));
  return section;
}

report::Table comparison_table(const std::vector<Comparison>& lines) {
  report::Table table;
  table.caption = "Beside the paper";
  for (const char* name : {"what", "paper", "here", "agrees"}) {
    report::Column column;
    column.name = name;
    table.columns.push_back(column);
  }
  for (const Comparison& line : lines) {
    const std::string agrees = !line.agrees ? "" : *line.agrees ? "yes" : "no";
    table.rows.push_back({line.what, line.paper, line.here, agrees});
  }
  return table;
}

report::KeyFigure key_figure(const std::string& label, const std::optional<double>& value,
                             const std::string& unit, const std::string& format,
                             const std::string& note = "") {
  report::KeyFigure result;
  result.label = label;
  if (value) {
    result.value = *value;
    result.unit = unit;
  } else {
    result.value = std::string("none");
  }
  result.format = format;
  result.note = note;
  return result;
}

report::KeyFigures key_figures(const ExperimentResult& run) {
  report::KeyFigures keys;
  keys.figures = {
      key_figure("detection", run.detection_time_s, "s", ".3f"),
      key_figure("largest |e| / mu before the fault", run.max_error_to_threshold_before_fault, "1",
                 ".3f", "an alarm is above 1"),
      key_figure("tracking error, rms", run.tracking_rms_rad, "rad", ".4f", "last quarter"),
      key_figure("error of the fault estimate", run.fault_estimate_relative_error, "1", ".3f",
                 "last quarter, share of the fault"),
      key_figure("largest |theta|", run.max_weight_norm, "1", ".2f"),
  };
  return keys;
}

}  // namespace

std::string words_of(const ExperimentResult& run) {
  std::string words;
  if (!run.fault_time_s) {
    words = run.detection_time_s
                ? fmt::format("There is no fault, but an alarm at {:.3f} s.", *run.detection_time_s)
                : std::string("There is no fault and no alarm.");
  } else if (!run.detection_time_s) {
    words = fmt::format("The fault that begins at {:g} s is not detected.", *run.fault_time_s);
  } else if (*run.detection_time_s <= *run.fault_time_s) {
    words = fmt::format("False alarm at {:.3f} s, before the fault at {:g} s.",
                        *run.detection_time_s, *run.fault_time_s);
  } else {
    words = fmt::format("The fault that begins at {:g} s is detected at {:.3f} s, {:.3f} s later.",
                        *run.fault_time_s, *run.detection_time_s,
                        *run.detection_time_s - *run.fault_time_s);
  }
  // A run that has stopped early has no last quarter.
  if (!std::isfinite(run.tracking_rms_rad)) return words;
  words += fmt::format(" {} accommodation the tracking error is {:.4f} rad (rms, last quarter).",
                       run.accommodate ? "With" : "Without", run.tracking_rms_rad);
  return words;
}

report::Page page_of(const PaperRuns& runs, const std::vector<Comparison>& lines,
                     const std::string& verdict, const std::string& command_line) {
  report::Page page;
  page.title = "Fault diagnosis of a two-link arm";
  page.subtitle =
      "Section 5 of Vemuri and Polycarpou, A methodology for fault diagnosis in robotic "
      "systems using neural networks, run again";
  const bool good = std::all_of(lines.begin(), lines.end(),
                                [](const Comparison& line) { return line.agrees.value_or(true); });
  page.verdict = {verdict, good ? Level::kGood : Level::kWarn};
  report::Section overview;
  overview.heading = "Results";
  overview.blocks.emplace_back(comparison_table(lines));
  page.sections = {std::move(overview),
                   fault_section("Mass of link 1 falls", runs.mass_loss, 8),
                   fault_section("Nonlinear fault", runs.nonlinear, 11),
                   accommodation_section(runs),
                   sweep_section(runs.sweep),
                   fault_section("No fault", runs.healthy, 0)};
  page.command_line = command_line;
  return page;
}

report::Page page_of(const ExperimentResult& run, const std::string& command_line) {
  report::Page page;
  page.title = "Two-link arm, fault: " + name_of(run.fault);
  page.subtitle = fmt::format("{} steps, {}, seed {}{}", run.steps, name_of(run.precision),
                              run.seed, run.accommodate ? ", accommodated" : "");
  const bool false_alarm =
      run.detection_time_s && (!run.fault_time_s || *run.detection_time_s <= *run.fault_time_s);
  const bool missed = run.fault_time_s && !run.detection_time_s;
  page.verdict = {words_of(run), false_alarm || missed ? Level::kWarn : Level::kGood};
  report::Section numbers;
  numbers.heading = "Results";
  numbers.blocks.emplace_back(key_figures(run));
  page.sections = {std::move(numbers), fault_section("Run", run, 0)};
  page.command_line = command_line;
  return page;
}

}  // namespace offnominal::desk::paper
