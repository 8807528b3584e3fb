#include "compare/torque_charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/effort_name.hpp"
#include "report/numbers.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using report::Axis;
using report::Chart;
using report::numbers;
using report::Series;
using report::SeriesKind;
using report::Tone;

Axis axis(const std::string& name, const std::string& unit) {
  Axis result;
  result.name = name;
  result.unit = unit;
  return result;
}

Series series(const std::string& name, SeriesKind kind, Tone tone, std::vector<double> x,
              std::vector<double> y) {
  Series result;
  result.name = name;
  result.kind = kind;
  result.tone = tone;
  result.x = std::move(x);
  result.y = std::move(y);
  return result;
}

std::string effort_unit(const Comparison& comparison, std::size_t joint) {
  return comparison.joints[joint].unit;
}

Chart time_chart(const Comparison& comparison, std::size_t joint, const std::string& title) {
  Chart chart;
  chart.title = fmt::format("Joint {}: {}", joint + 1, title);
  chart.x = axis("time", "s");
  chart.y = {axis(effort_name(effort_unit(comparison, joint)), effort_unit(comparison, joint))};
  chart.zoom_group = "time";
  return chart;
}

}  // namespace

Chart torque_over_time(const std::vector<NamedComparison>& models, std::size_t joint) {
  const Comparison& any = *models.front().comparison;
  const auto column = static_cast<Index>(joint);
  Chart chart = time_chart(
      any, joint, fmt::format("measured and model {}", effort_name(effort_unit(any, joint))));
  chart.series.push_back(series("measured", SeriesKind::kLine, Tone::kMeasured, numbers(any.t_s),
                                numbers(any.measured.col(column))));
  for (const NamedComparison& model : models) {
    chart.series.push_back(series(model.name, SeriesKind::kLine, model.tone, numbers(any.t_s),
                                  numbers(model.comparison->model.col(column))));
  }
  chart.slider = true;
  return chart;
}

Chart residual_over_time(const std::vector<NamedComparison>& models, std::size_t joint) {
  const Comparison& any = *models.front().comparison;
  const auto column = static_cast<Index>(joint);
  Chart chart = time_chart(any, joint, "residual (measured minus model)");
  for (const NamedComparison& model : models) {
    const Tone tone = models.size() == 1 ? Tone::kResidual : model.tone;
    chart.series.push_back(series(
        models.size() == 1 ? "residual" : model.name, SeriesKind::kLine, tone, numbers(any.t_s),
        numbers(model.comparison->measured.col(column) - model.comparison->model.col(column))));
  }
  return chart;
}

Series binned_mean(const std::string& name, Tone tone, const Eigen::Ref<const VectorXd>& variable,
                   const Eigen::Ref<const VectorXd>& values) {
  constexpr std::size_t kBins = 40;
  std::vector<Index> order;
  for (Index i = 0; i < variable.size(); ++i) {
    if (!std::isnan(variable[i]) && !std::isnan(values[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return variable[a] < variable[b]; });
  Series result = series(name, SeriesKind::kLine, tone, {}, {});
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const std::size_t first = order.size() * bin / kBins;
    const std::size_t end = order.size() * (bin + 1) / kBins;
    if (first == end) continue;
    double x = 0;
    double y = 0;
    for (std::size_t i = first; i < end; ++i) {
      x += variable[order[i]];
      y += values[order[i]];
    }
    result.x.push_back(x / static_cast<double>(end - first));
    result.y.push_back(y / static_cast<double>(end - first));
  }
  return result;
}

Chart residual_over(const std::vector<NamedComparison>& models, std::size_t joint,
                    const ErrorOver& over) {
  const Comparison& any = *models.front().comparison;
  const auto column = static_cast<Index>(joint);
  const VectorXd x = values_of(any, over);
  Chart chart;
  chart.x = axis_of(any, over, joint);
  chart.title = fmt::format("Joint {}: residual over {}", joint + 1, chart.x.name);
  chart.y = {axis(effort_name(effort_unit(any, joint)), effort_unit(any, joint))};
  chart.width = report::Width::kHalf;
  for (const NamedComparison& model : models) {
    const bool alone = models.size() == 1;
    const VectorXd residual =
        model.comparison->measured.col(column) - model.comparison->model.col(column);
    const Tone tone = alone ? Tone::kResidual : model.tone;
    chart.series.push_back(series(alone ? "residual" : model.name, SeriesKind::kPoints, tone,
                                  numbers(x), numbers(residual)));
    chart.series.push_back(binned_mean(alone ? "mean of bins" : model.name + ", mean of bins",
                                       alone ? Tone::kThreshold : model.tone, x, residual));
  }
  return chart;
}

}  // namespace offnominal::desk
