#include "replay/residual_chart.hpp"

#include <utility>

#include "report/act_level.hpp"

namespace offnominal::desk {

report::Chart chart_against_threshold(EstimatorSpace space, const std::string& unit,
                                      report::Series residual, report::Series threshold,
                                      double act_ratio) {
  const bool in_torque = space == EstimatorSpace::kTorque;
  residual.name = in_torque ? "|residual|" : "|e|";
  residual.tone = report::Tone::kResidual;
  threshold.name = in_torque ? "threshold" : "threshold mu";
  threshold.tone = report::Tone::kThreshold;
  report::Chart chart;
  chart.x = {.name = "time", .unit = "s"};
  chart.y = {{.name = in_torque ? "torque" : "velocity", .unit = unit}};
  chart.series = {std::move(residual), std::move(threshold)};
  if (act_ratio > 1) chart.series.push_back(report::act_level(chart.series.back(), act_ratio));
  return chart;
}

}  // namespace offnominal::desk
