#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "campaign/summary_report.hpp"

namespace offnominal::desk::campaign {
namespace {

// Of one detector: how long after the fault, and in how many runs there was one.
struct Delays {
  std::vector<double> seen_s;
  std::int64_t runs = 0;
  double longest_s = 0;  // that it had time for
};

report::Series series_of(const std::string& detector, Delays delays) {
  report::Series series;
  series.name = detector;
  series.kind = report::SeriesKind::kSteps;
  std::sort(delays.seen_s.begin(), delays.seen_s.end());
  const auto runs = static_cast<double>(delays.runs);
  series.x.push_back(0);
  series.y.push_back(0);
  for (std::size_t i = 0; i < delays.seen_s.size(); ++i) {
    series.x.push_back(delays.seen_s[i]);
    series.y.push_back(100 * static_cast<double>(i + 1) / runs);
  }
  series.x.push_back(std::max(delays.longest_s, series.x.back()));
  series.y.push_back(series.y.back());
  return series;
}

}  // namespace

std::optional<report::Chart> delay_chart_of(const Results& results) {
  std::map<std::string, Delays> of;
  for (const Result& row : results.rows) {
    if (!row.fault_s) continue;
    Delays& delays = of[row.detector];
    ++delays.runs;
    if (row.detected && row.delay_s) delays.seen_s.push_back(*row.delay_s);
    if (row.delay_s) delays.longest_s = std::fmax(delays.longest_s, *row.delay_s);
  }
  if (of.empty()) return std::nullopt;
  double longest_s = 0;
  for (const auto& [name, delays] : of) longest_s = std::fmax(longest_s, delays.longest_s);
  report::Chart chart;
  chart.title = "Time from fault to alarm";
  chart.x = {"time since the fault", "s", false, 0, {}};
  chart.y = {{"runs whose fault is seen by then", "%", false, 0, 100}};
  for (const DetectorRow& detector : results.campaign.detectors) {
    const auto found = of.find(detector.name);
    if (found == of.end()) continue;
    found->second.longest_s = longest_s;
    chart.series.push_back(series_of(detector.name, std::move(found->second)));
  }
  chart.note =
      "The distribution of the time to detect. Runs whose fault is not seen, or that have an alarm "
      "before it, count as never: the curve ends below 100 %.";
  return chart;
}

}  // namespace offnominal::desk::campaign
