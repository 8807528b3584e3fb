#include "studio/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/effort_name.hpp"
#include "common/plain_words.hpp"
#include "common/refused.hpp"
#include "compare/torque_charts.hpp"
#include "report/decimate.hpp"
#include "report/numbers.hpp"
#include "report/page.hpp"

namespace offnominal::desk::studio {

using Eigen::Index;
using Eigen::VectorXd;
using report::Chart;
using report::Series;
using report::Tone;

namespace {

constexpr std::size_t kMostPoints = 3000;  // of a cloud

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

// Another recording over the one that is shown: what it measured, and its error.
void lay_over(const Compared& now, const View& view, Chart& torque, Chart& error) {
  const Comparison& shown = recording_of(now, view.recording);
  const Comparison& other = recording_of(now, *view.beside);
  const auto column = static_cast<Index>(view.joint);
  const VectorXd t_s = other.t_s.array() + (shown.t_s[0] - other.t_s[0]);
  const std::string name = std::filesystem::path(other.file).filename().string();
  const auto put = [&](Chart& chart, const std::string& what, const VectorXd& values) {
    Series series;
    series.name = what + ", " + name;
    series.tone = Tone::kThreshold;
    series.x = report::numbers(t_s);
    series.y = report::numbers(values);
    chart.series.push_back(std::move(series));
  };
  put(torque, "measured", other.measured.col(column));
  put(error, "error now", other.measured.col(column) - other.model.col(column));
}

std::vector<Chart> time_charts(const Workbench& bench, const Compared& now, const View& view,
                               const std::vector<report::SpanMark>& spans) {
  const Role& role = role_of(bench, view.recording);
  std::vector<NamedComparison> models;
  if (!bench.steps().empty()) {
    models.push_back({"model as read", &recording_of(bench.start(), view.recording), Tone::kFaint});
  }
  models.push_back(
      {std::string("model now, ") + role.name, &recording_of(now, view.recording), role.tone});
  Chart torque = torque_over_time(models, view.joint);
  Chart error = residual_over_time(models, view.joint);
  error.title = fmt::format("Joint {}: error (measured minus model)", view.joint + 1);
  error.series.back().name = std::string("error now, ") + role.name;
  if (models.size() == 1) {
    error.series[0].tone = models[0].tone;
  } else {
    error.series[0].name = "error as read";
  }
  if (view.beside) lay_over(now, view, torque, error);
  std::vector<Chart> charts{std::move(torque), std::move(error)};
  for (Chart& chart : charts) {
    for (Series& series : chart.series) series = seen(series, view);
    chart.max_points = 6 * kMostPixels;
    if (view.recording == 0) chart.events = bench.input().marks;
    chart.spans = spans;
  }
  return charts;
}

// Error over a variable, of all samples of some recordings.
struct Cloud {
  VectorXd at;
  VectorXd error;
};

Cloud cloud_of(const Comparison& one, std::size_t joint, const ErrorOver& over,
               const Shown& shown) {
  const auto column = static_cast<Index>(joint);
  return {values_of(one, over).segment(shown.first, shown.count),
          (one.measured.col(column) - one.model.col(column)).segment(shown.first, shown.count)};
}

Cloud cloud_of(const std::vector<Comparison>& recordings, std::size_t joint,
               const ErrorOver& over) {
  std::vector<Cloud> parts;
  Index count = 0;
  for (const Comparison& one : recordings) {
    parts.push_back(cloud_of(one, joint, over, {0, one.t_s.size()}));
    count += one.t_s.size();
  }
  Cloud all{VectorXd(count), VectorXd(count)};
  Index row = 0;
  for (const Cloud& part : parts) {
    all.at.segment(row, part.at.size()) = part.at;
    all.error.segment(row, part.at.size()) = part.error;
    row += part.at.size();
  }
  return all;
}

Chart cloud_chart(const Workbench& bench, const Compared& now, const View& view,
                  ErrorVariable variable) {
  const ErrorOver over{variable, view.joint};
  const Comparison& any = now.fitted.recordings.front();
  const std::string& unit = any.joints[view.joint].unit;
  const bool is_part = view.from_s && view.to_s;
  const auto tone = [&](const Role& role) { return is_part ? Tone::kFaint : role.tone; };
  Chart chart;
  chart.x = axis_of(any, over, view.joint);
  chart.y = {{effort_name(unit), unit}};
  chart.title = fmt::format("Joint {}: error over {}", view.joint + 1, chart.x.name);
  chart.width = report::Width::kHalf;
  chart.max_points = kMostPoints;
  const Cloud fitted = cloud_of(now.fitted.recordings, view.joint, over);
  chart.series.push_back(points_of(kFitted.name, tone(kFitted), fitted.at, fitted.error));
  if (now.held_out) {
    const Cloud others = cloud_of(now.held_out->recordings, view.joint, over);
    chart.series.push_back(points_of(kHeldOut.name, tone(kHeldOut), others.at, others.error));
  }
  const Comparison& seen = recording_of(now, view.recording);
  // A zoom between two samples, or past the end, shows none of them.
  if (const Shown shown = shown_of(seen, view); is_part && shown.count > 0) {
    const Cloud part = cloud_of(seen, view.joint, over, shown);
    chart.series.push_back(points_of("the time that is shown", role_of(bench, view.recording).tone,
                                     part.at, part.error));
  }
  chart.series.push_back(binned_mean(std::string(kFitted.name) + ", mean of bins", Tone::kThreshold,
                                     fitted.at, fitted.error));
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

[[noreturn]] void refuse_view(const std::string& words) {
  throw Refused(Refused::Why::kBadRequest, words);
}

}  // namespace

void check_shown(const std::optional<double>& from_s, const std::optional<double>& to_s) {
  if (from_s.has_value() != to_s.has_value()) {
    refuse_view("from and to go together: one of them is missing.");
  }
  if (from_s && !(*from_s < *to_s)) refuse_view("from has to lie before to.");
}

void check(const Workbench& bench, const View& view) {
  const Treated& all = *bench.input().recordings;
  if (view.joint >= bench.robot().joints.size()) refuse_view("There is no such joint.");
  const std::size_t count = all.logs.size() + all.holdout.size();
  if (view.recording >= count || view.beside.value_or(0) >= count)
    refuse_view("No such recording.");
  check_shown(view.from_s, view.to_s);
}

const Role& role_of(const Workbench& bench, std::size_t recording) {
  return recording < bench.input().recordings->logs.size() ? kFitted : kHeldOut;
}

Shown shown_of(const Comparison& recording, const View& view) {
  const VectorXd& t_s = recording.t_s;
  if (!view.from_s || !view.to_s) return {0, t_s.size()};
  const auto first = std::lower_bound(t_s.begin(), t_s.end(), *view.from_s);
  const auto end = std::upper_bound(first, t_s.end(), *view.to_s);
  return {first - t_s.begin(), end - first};
}

std::string effect_title(const char* name) { return capitalised(in_words(name)); }

Series points_of(const std::string& name, Tone tone, const VectorXd& x, const VectorXd& y) {
  Series series;
  series.name = name;
  series.kind = report::SeriesKind::kPoints;
  series.tone = tone;
  series.x = report::numbers(x);
  series.y = report::numbers(y);
  return series;
}

nlohmann::json block_of(report::Block block) { return blocks_of({std::move(block)}).at(0); }

nlohmann::json charts_of(const Workbench& bench, const Compared& now, const View& view,
                         const std::vector<report::SpanMark>& spans) {
  check(bench, view);
  std::vector<report::Block> blocks;
  for (Chart& chart : time_charts(bench, now, view, spans)) blocks.emplace_back(std::move(chart));
  blocks.emplace_back(cloud_chart(bench, now, view, ErrorVariable::kVelocity));
  blocks.emplace_back(cloud_chart(bench, now, view, ErrorVariable::kPosition));
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
    const std::string label =
        steps == 0 ? "as read"
                   : fmt::format("{}. {}, joint {}", steps,
                                 effect_title(info_of(bench.steps()[steps - 1].kind)->name),
                                 bench.steps()[steps - 1].joint + 1);
    fall.steps.push_back({label, bench.held_out_percent(joint, steps)});
  }
  return block_of(std::move(fall));
}

}  // namespace offnominal::desk::studio
