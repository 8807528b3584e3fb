#include "replay/residual_chart.hpp"

#include <utility>

namespace offnominal::desk {

report::Chart chart_against_threshold(EstimatorSpace space, const std::string& unit,
                                      report::Series residual, report::Series threshold) {
  const bool in_torque = space == EstimatorSpace::kTorque;
  residual.name = in_torque ? "|residual|" : "|e|";
  residual.tone = report::Tone::kResidual;
  threshold.name = in_torque ? "threshold" : "threshold mu";
  threshold.tone = report::Tone::kThreshold;
  report::Chart chart;
  chart.x = {.name = "time", .unit = "s"};
  chart.y = {{.name = in_torque ? "torque" : "velocity", .unit = unit}};
  chart.series = {std::move(residual), std::move(threshold)};
  return chart;
}

}  // namespace offnominal::desk
