#include "studio/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/refused.hpp"
#include "compare/torque_charts.hpp"
#include "report/decimate.hpp"
#include "report/page.hpp"

namespace offnominal::desk::studio {

using Eigen::Index;
using Eigen::MatrixXd;
using report::Chart;
using report::Series;
using report::Tone;

namespace {

constexpr const char* kFittedName = "fitted data";
constexpr const char* kHeldOutName = "held-out data";
constexpr Tone kFittedTone = Tone::kModel;
constexpr Tone kHeldOutTone = Tone::kResidual;
constexpr std::size_t kMostPoints = 3000;  // of a cloud

const std::vector<Comparison>* held_out(const Compared& compared) {
  return compared.held_out ? &compared.held_out->recordings : nullptr;
}

void check(const Workbench& bench, const View& view) {
  const Treated& all = *bench.input().recordings;
  const auto refuse = [](const std::string& words) {
    throw Refused(Refused::Why::kBadRequest, words);
  };
  if (view.joint >= bench.robot().joints.size()) refuse("There is no such joint.");
  if (view.recording >= all.logs.size() + all.holdout.size()) refuse("No such recording.");
  if (view.pixels < kFewestPixels || view.pixels > kMostPixels) {
    refuse(fmt::format("The width has to be {} to {} pixels.", kFewestPixels, kMostPixels));
  }
}

// Points `first` to `end`, that one left out, two per pixel at most.
void append_part(const Series& whole, std::size_t first, std::size_t end, std::size_t pixels,
                 Series& to) {
  if (first >= end) return;
  Series part = whole;
  const auto cut = [&](std::vector<double>& values) {
    values.resize(end);
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  cut(part.x);
  cut(part.y);
  part = report::decimate(part, std::max(2 * pixels, report::kMinDecimatedPoints));
  to.x.insert(to.x.end(), part.x.begin(), part.x.end());
  to.y.insert(to.y.end(), part.y.begin(), part.y.end());
}

// The part of the time that is seen in full, what lies beside it as the whole would be drawn.
Series seen(const Series& whole, const View& view) {
  if (!view.from_s || !view.to_s) {
    return report::decimate(whole, std::max(2 * view.pixels, report::kMinDecimatedPoints));
  }
  const auto at = [&](double t_s) {
    return static_cast<std::size_t>(std::lower_bound(whole.x.begin(), whole.x.end(), t_s) -
                                    whole.x.begin());
  };
  const std::size_t first = at(*view.from_s);
  const std::size_t end = std::max(first, at(*view.to_s));
  Series result = whole;
  result.x.clear();
  result.y.clear();
  append_part(whole, 0, first, view.pixels / 2, result);
  append_part(whole, first, end, view.pixels, result);
  append_part(whole, end, whole.x.size(), view.pixels / 2, result);
  return result;
}

std::vector<Chart> time_charts(const Workbench& bench, const View& view) {
  const Comparison& now = recording_of(bench.now(), view.recording);
  const bool is_fitted = view.recording < bench.now().fitted.recordings.size();
  const std::string role = is_fitted ? kFittedName : kHeldOutName;
  std::vector<NamedComparison> models;
  if (!bench.steps().empty()) {
    models.push_back({"model as read", &recording_of(bench.start(), view.recording), Tone::kFaint});
  }
  models.push_back({"model now, " + role, &now, is_fitted ? kFittedTone : kHeldOutTone});
  Chart torque = torque_over_time(models, view.joint);
  Chart error = residual_over_time(models, view.joint);
  error.title = fmt::format("Joint {}: error (measured minus model)", view.joint + 1);
  if (models.size() == 1) {
    error.series[0].name = "error now, " + role;
    error.series[0].tone = models[0].tone;
  } else {
    error.series[0].name = "error as read";
    error.series[1].name = "error now, " + role;
  }
  std::vector<Chart> charts{std::move(torque), std::move(error)};
  for (Chart& chart : charts) {
    for (Series& series : chart.series) series = seen(series, view);
    chart.max_points = 6 * kMostPixels;
    if (view.recording == 0) chart.events = bench.input().marks;
  }
  return charts;
}

// All samples of recordings as those of one, of which only a cloud is made.
Comparison joined(const std::vector<Comparison>& recordings) {
  Comparison all = recordings.front();
  const auto stack = [&](MatrixXd Comparison::*what) {
    Index rows = 0;
    for (const Comparison& one : recordings) rows += (one.*what).rows();
    MatrixXd stacked(rows, (recordings.front().*what).cols());
    Index row = 0;
    for (const Comparison& one : recordings) {
      stacked.middleRows(row, (one.*what).rows()) = one.*what;
      row += (one.*what).rows();
    }
    all.*what = std::move(stacked);
  };
  for (MatrixXd Comparison::*what : {&Comparison::measured, &Comparison::model, &Comparison::q,
                                     &Comparison::dq, &Comparison::ddq}) {
    stack(what);
  }
  return all;
}

Chart cloud(const Compared& now, std::size_t joint, MotionVariable variable) {
  const Comparison fitted = joined(now.fitted.recordings);
  Chart chart = residual_over({{kFittedName, &fitted, kFittedTone}}, joint, variable);
  chart.title = fmt::format("Joint {}: error over {}", joint + 1, chart.x.name);
  chart.series[0].name = kFittedName;
  chart.series[0].tone = kFittedTone;
  chart.series[1].name = std::string(kFittedName) + ", mean of bins";
  if (const auto* others = held_out(now)) {
    const Comparison apart = joined(*others);
    Chart beside = residual_over({{kHeldOutName, &apart, kHeldOutTone}}, joint, variable);
    beside.series[0].name = kHeldOutName;
    beside.series[0].tone = kHeldOutTone;
    chart.series.insert(chart.series.begin() + 1, std::move(beside.series[0]));
  }
  chart.max_points = kMostPoints;
  return chart;
}

nlohmann::json blocks_of(std::vector<report::Block> blocks) {
  report::Page page;
  page.title = "studio";
  page.verdict.words = "studio";
  report::Section section;
  section.heading = "studio";
  section.blocks = std::move(blocks);
  page.sections.push_back(std::move(section));
  return report::to_json(page).at("sections").at(0).at("blocks");
}

}  // namespace

nlohmann::json time_charts_of(const Workbench& bench, const View& view) {
  check(bench, view);
  std::vector<report::Block> blocks;
  for (Chart& chart : time_charts(bench, view)) blocks.emplace_back(std::move(chart));
  return blocks_of(std::move(blocks));
}

nlohmann::json charts_of(const Workbench& bench, const View& view) {
  check(bench, view);
  std::vector<report::Block> blocks;
  for (Chart& chart : time_charts(bench, view)) blocks.emplace_back(std::move(chart));
  blocks.emplace_back(cloud(bench.now(), view.joint, MotionVariable::kVelocity));
  blocks.emplace_back(cloud(bench.now(), view.joint, MotionVariable::kPosition));
  return blocks_of(std::move(blocks));
}

nlohmann::json waterfall_of(const Workbench& bench, std::size_t joint) {
  report::Waterfall fall;
  const bool apart = bench.start().held_out.has_value();
  fall.title = fmt::format("Joint {}: error step by step, {}", joint + 1,
                           apart ? "on held-out recordings" : "on held-out parts");
  fall.value_axis.name = "error";
  fall.value_axis.unit = "%";
  fall.value_axis.min = 0;
  fall.format = ".2f";
  const std::size_t count = bench.steps().size();
  for (std::size_t steps = 0; steps <= count; ++steps) {
    const std::string label = steps == 0 ? "as read"
                                         : fmt::format("{}. {}, joint {}", steps,
                                                       info_of(bench.steps()[steps - 1].kind)->name,
                                                       bench.steps()[steps - 1].joint + 1);
    fall.steps.push_back({label, bench.held_out_percent(joint, steps)});
  }
  return blocks_of({std::move(fall)}).at(0);
}

}  // namespace offnominal::desk::studio
