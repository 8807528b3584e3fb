#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibrate/calibrate_report.hpp"
#include "replay/residual_chart.hpp"
#include "report/numbers.hpp"

namespace offnominal::desk {
namespace {

using namespace report;  // a page is written in its own words

constexpr int kHistogramBars = 40;

KeyFigures figures_of(const Calibration& calibration) {
  const BoundMargin margin = margin_of(calibration);
  const FalseAlarmLevel& level = calibration.level;
  KeyFigures figures;
  if (margin.mean_before) {
    figures.figures.push_back(
        {.label = "mean threshold, old", .value = *margin.mean_before, .unit = calibration.unit});
  }
  figures.figures.push_back(
      {.label = "mean threshold, new",
       .value = margin.mean_after,
       .unit = calibration.unit,
       .level = margin.is_remarkable() ? Level::kWarn : Level::kGood,
       .note = margin.new_to_old ? fmt::format("{:.3g} times the old", *margin.new_to_old) : ""});
  figures.figures.push_back(
      {.label = "largest |e| / mu",
       .value = margin.largest_ratio_after,
       .unit = "",
       .format = ".3g",
       .note = margin.largest_ratio_before
                   ? fmt::format("with the old bound {:.3g}", *margin.largest_ratio_before)
                   : ""});
  figures.figures.push_back({.label = "hold-out alarms",
                             .value = static_cast<double>(level.held_out_alarms),
                             .unit = "",
                             .format = "d",
                             .level = level.held_out_alarms == 0 ? Level::kGood : Level::kBad,
                             .note = fmt::format("in {:g} s", level.held_out_s)});
  figures.figures.push_back({.label = "false alarms aimed at",
                             .value = level.alarms_per_hour,
                             .unit = "1/h",
                             .note = "extrapolated"});
  return figures;
}

Level level_of(const Calibration& calibration) {
  if (!calibration.objections.empty()) return Level::kBad;
  return margin_of(calibration).is_remarkable() ? Level::kWarn : Level::kGood;
}

Waterfall bars_of(const Calibration& calibration) {
  const BoundMargin margin = margin_of(calibration);
  Waterfall bars;
  bars.title = "Mean threshold";
  bars.value_axis = {.name = "mu", .unit = calibration.unit};
  if (margin.mean_before) bars.steps.push_back({"old bound", *margin.mean_before});
  bars.steps.push_back({"new bound", margin.mean_after});
  bars.note = "A fault is seen when it lifts |e| above mu: the lower, the smaller the fault.";
  return bars;
}

Chart threshold_chart(const Calibration& calibration, const JudgedStretch& stretch,
                      std::size_t index) {
  Chart chart =
      chart_against_threshold(EstimatorSpace::kAcceleration, calibration.unit,
                              {.x = numbers(stretch.t_s), .y = numbers(stretch.error_norm)},
                              {.x = numbers(stretch.t_s), .y = numbers(stretch.threshold_after)});
  chart.title = stretch.file + (stretch.held_out ? ", hold-out" : "");
  chart.series.back().name += ", new";
  if (stretch.threshold_before.size() > 0) {
    chart.series.insert(chart.series.end() - 1, Series{.name = "threshold mu, old",
                                                       .x = numbers(stretch.t_s),
                                                       .y = numbers(stretch.threshold_before),
                                                       .tone = Tone::kFaint});
  }
  chart.zoom_group = fmt::format("recording {}", index);
  chart.slider = true;
  return chart;
}

Series histogram(const std::string& name, const Calibration& calibration, bool after, Tone tone) {
  Series bars{.name = name, .kind = SeriesKind::kBars, .tone = tone};
  for (int i = 0; i <= kHistogramBars; ++i) bars.x.push_back(1.25 * i / kHistogramBars);
  bars.y.assign(kHistogramBars, 0.0);
  double samples = 0;
  for (const JudgedStretch& stretch : calibration.stretches) {
    const Eigen::VectorXd& mu = after ? stretch.threshold_after : stretch.threshold_before;
    for (Eigen::Index i = 0; i < mu.size(); ++i) {
      if (!(mu[i] > 0)) continue;
      const double place = stretch.error_norm[i] / mu[i] / 1.25 * kHistogramBars;
      ++bars.y[static_cast<std::size_t>(std::min(place, kHistogramBars - 1.0))];
      ++samples;
    }
  }
  for (double& bar : bars.y) bar *= 100 / std::max(samples, 1.0);
  return bars;
}

Chart ratio_chart(const Calibration& calibration) {
  Chart chart;
  chart.title = "How close |e| comes to the threshold";
  chart.x = {.name = "|e| / mu", .unit = "1"};
  chart.y = {{.name = "share of samples", .unit = "%"}};
  if (calibration.old_bound) {
    chart.series.push_back(histogram("old bound", calibration, false, Tone::kFaint));
  }
  chart.series.push_back(histogram("new bound", calibration, true, Tone::kModel));
  chart.events.push_back({1.0, "alarm", Level::kBad});
  chart.note = "The last bar holds what lies beyond.";
  return chart;
}

// Where maxima of the extreme-value law stand on a straight line.
Chart law_chart(const Calibration& calibration) {
  const FalseAlarmLevel& level = calibration.level;
  std::vector<double> maxima = calibration.unseen_maxima;
  std::sort(maxima.begin(), maxima.end());
  Chart chart;
  chart.title = "Largest |e| / mu of a block, and the law that is extrapolated";
  chart.x = {.name = "one block in", .unit = "1", .log = true};
  chart.y = {{.name = "|e| / mu before widening", .unit = "1"}};
  Series seen{.name = "blocks the bound had not seen",
              .kind = SeriesKind::kPoints,
              .tone = Tone::kMeasured};
  Series law{.name = "law", .kind = SeriesKind::kLine, .tone = Tone::kModel};
  const auto n = static_cast<double>(maxima.size());
  for (std::size_t i = 0; i < maxima.size(); ++i) {
    const double exceeded = 1 - (static_cast<double>(i) + 0.65) / (n + 0.3);
    seen.x.push_back(1 / exceeded);
    seen.y.push_back(maxima[i]);
  }
  const double rarest = 3600 / (level.alarms_per_hour * level.block_s);
  for (double rare = 1.1; rare < 2 * std::max(rarest, n); rare *= 1.3) {
    law.x.push_back(rare);
    law.y.push_back(exceeded_with(level.law, 1 / rare));
  }
  chart.series = {seen, law};
  chart.events.push_back(
      {rarest, fmt::format("{:g} per hour", level.alarms_per_hour), Level::kNeutral});
  return chart;
}

Table shape_table(const Calibration& calibration) {
  Table table;
  table.caption = "Shapes of the bound that were tried";
  table.columns = {{"shape", ""},
                   {"largest |e| / mu on unseen parts", "1", ".3f"},
                   {"widened by", "1", ".3f"},
                   {"mean mu", calibration.unit, ".4g"},
                   {"choice", ""}};
  for (const ShapeScore& shape : calibration.shapes) {
    table.rows.push_back({shape.words, shape.largest_unseen_ratio, shape.widening,
                          shape.mean_threshold, std::string(shape.chosen ? "chosen" : "")});
  }
  return table;
}

Table bound_table(const Calibration& calibration) {
  Table table;
  table.caption = "Uncertainty bound mu_bar";
  table.columns = {{"robot file", ""}, {"bound", ""}};
  if (calibration.old_bound) {
    table.rows.push_back({std::string("old"), words_of(*calibration.old_bound, calibration.unit)});
  }
  table.rows.push_back({std::string("new"), words_of(*calibration.robot.bound, calibration.unit)});
  return table;
}

}  // namespace

void add_remarks(const std::vector<std::string>& notes, const std::vector<std::string>& objections,
                 report::Section& section) {
  for (const std::string& objection : objections) {
    section.blocks.emplace_back(Note{objection, Level::kBad});
  }
  for (const std::string& note : notes) section.blocks.emplace_back(Note{note, Level::kWarn});
}

report::Page page_of(const Calibration& calibration, const CalibrateNames& names) {
  Page page;
  page.title = "Calibrated uncertainty bound of " + names.robot;
  page.subtitle = "judged after the filter: |e| against mu = W[mu_bar]";
  page.verdict = {verdict_of(calibration), level_of(calibration)};
  page.command_line = names.command_line;
  Section result{.heading = "The bound", .text = "", .blocks = {}};
  result.blocks.emplace_back(figures_of(calibration));
  add_remarks(calibration.notes, calibration.objections, result);
  result.blocks.emplace_back(bound_table(calibration));
  if (calibration.old_bound) result.blocks.emplace_back(bars_of(calibration));
  page.sections.push_back(result);

  Section time{.heading = "Error against threshold", .text = "", .blocks = {}};
  for (std::size_t i = 0; i < calibration.stretches.size(); ++i) {
    time.blocks.emplace_back(threshold_chart(calibration, calibration.stretches[i], i));
  }
  time.blocks.emplace_back(ratio_chart(calibration));
  page.sections.push_back(time);

  Section level{.heading = "False alarms", .text = "", .blocks = {}};
  level.text = fmt::format(
      "Parts of the recordings take turns at being left out; the tightest bound of the others is "
      "judged on them. The bound is widened so that a block of {:g} s exceeds it {:g} times per "
      "hour by the law below. That takes blocks as independent and motions as in these "
      "recordings. By itself the count on hold-out data, {} in {:g} s, excludes more than {:.3g} "
      "alarms per hour at 95 % confidence.",
      calibration.level.block_s, calibration.level.alarms_per_hour,
      calibration.level.held_out_alarms, calibration.level.held_out_s,
      calibration.level.highest_per_hour);
  level.blocks.emplace_back(law_chart(calibration));
  level.blocks.emplace_back(shape_table(calibration));
  page.sections.push_back(level);
  return page;
}

}  // namespace offnominal::desk
