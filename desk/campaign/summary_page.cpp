#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "campaign/summary_report.hpp"
#include "common/amount.hpp"

namespace offnominal::desk::campaign {
namespace {

using report::Cell;
using report::Chart;
using report::Section;
using report::Series;
using report::SeriesKind;

Cell cell_of(const std::optional<double>& value) {
  return value ? Cell(*value) : Cell(std::monostate{});
}

report::Table faults_table(const DetectorSummary& detector) {
  report::Table table;
  table.caption = detector.name;
  table.columns = {{"fault", "", {}},         {"size", "", {}},          {"runs", "1", "d"},
                   {"seen", "%", ".1f"},      {"from", "%", ".1f"},      {"to", "%", ".1f"},
                   {"median", "s", ".3f"},    {"p95", "s", ".3f"},       {"largest", "s", ".3f"},
                   {"joint named", "1", "d"}, {"joint right", "1", "d"}, {"early", "1", "d"}};
  for (report::Column& column : table.columns) {
    if (column.format.empty()) column.format = report::kDefaultFormat;
  }
  for (const FaultLine& line : detector.faults) {
    table.rows.push_back({place_words(line.kind, line.joint), size_words(line.kind, line.size),
                          static_cast<double>(line.runs), 100 * line.detected.value,
                          100 * line.detected.low, 100 * line.detected.high, cell_of(line.median_s),
                          cell_of(line.p95_s), cell_of(line.max_s), static_cast<double>(line.named),
                          static_cast<double>(line.joint_right), static_cast<double>(line.early)});
  }
  table.note =
      "Seen: an alarm after the fault began and none before, with its 95 % interval "
      "(Clopper-Pearson); times from the fault to the alarm, of the runs in which it was seen.";
  if (!detector.notes.empty()) table.note += " " + detector.notes;
  return table;
}

report::Table alarms_table(const Summary& summary) {
  report::Table table;
  table.caption = "False alarms of fault-free runs";
  table.columns = {{"detector", "", report::kDefaultFormat},
                   {"time", "h", ".4g"},
                   {"alarms", "1", "d"},
                   {"rate", "1/h", ".3g"},
                   {"from", "1/h", ".3g"},
                   {"to", "1/h", ".3g"},
                   {"thresholds with no alarm", "1", ".3g"},
                   {"faults seen by them", "%", ".1f"}};
  for (const DetectorSummary& detector : summary.detectors) {
    if (!detector.false_alarms_per_hour) continue;
    const Estimate& rate = *detector.false_alarms_per_hour;
    table.rows.push_back({detector.name, detector.fault_free_s / 3600,
                          static_cast<double>(detector.false_alarms), rate.value, rate.low,
                          rate.high});
    const auto& quiet = detector.without_false_alarm;
    table.rows.back().push_back(quiet ? Cell(quiet->scale) : Cell(std::monostate{}));
    table.rows.back().push_back(quiet ? Cell(100 * quiet->detected) : Cell(std::monostate{}));
  }
  table.note =
      "With the 95 % interval of a Poisson rate. The last two: times what they were calibrated to, "
      "the lowest thresholds without any alarm where there was no fault, before faults too.";
  return table;
}

// A point for each rate of false alarms, the best at it.
Series roc_series(const DetectorSummary& detector) {
  Series series;
  series.name = detector.name;
  series.kind = SeriesKind::kLine;
  const std::vector<RocPoint> points(detector.roc.rbegin(), detector.roc.rend());
  for (const RocPoint& point : points) {
    const double x = std::max(point.false_alarms_per_hour, 0.5 / detector.roc_hours);
    const double y = 100 * point.detected;
    if (!series.x.empty() && series.x.back() == x) {
      series.y.back() = std::max(series.y.back(), y);
    } else {
      series.x.push_back(x);
      series.y.push_back(y);
    }
  }
  return series;
}

std::optional<Chart> roc_chart(const Summary& summary) {
  Chart chart;
  chart.title = "Faults seen against false alarms";
  chart.x = {"runs that alarm without a fault", "1/h", true, {}, {}};
  chart.y = {{"runs whose fault is seen", "%", false, 0, 100}};
  for (const DetectorSummary& detector : summary.detectors) {
    if (!detector.roc.empty()) chart.series.push_back(roc_series(detector));
  }
  if (chart.series.empty()) return std::nullopt;
  chart.note =
      "Receiver operating characteristic over all faults: every detector's thresholds are scaled "
      "together, from a hundredth to ten times what they were calibrated to. None at all is drawn "
      "as "
      "half an alarm.";
  return chart;
}

// One place of a kind, over its sizes.
Chart size_chart(const Summary& summary, const SmallestSeen& place) {
  Chart chart;
  chart.title = place_words(place.kind, place.joint);
  std::string unit = "1";
  for (const FaultKindInfo& info : kFaultKinds) {
    if (place.kind == info.name) unit = info.unit;
  }
  chart.x = {"size", unit, false, {}, {}};
  chart.y = {{"runs in which it is seen", "%", false, 0, 100}};
  chart.width = report::Width::kHalf;
  for (const DetectorSummary& detector : summary.detectors) {
    std::vector<std::pair<double, double>> points;
    for (const FaultLine& line : detector.faults) {
      if (line.kind != place.kind || line.joint != place.joint || !line.size) continue;
      points.emplace_back(*line.size, 100 * line.detected.value);
    }
    std::sort(points.begin(), points.end());
    Series series;
    series.name = detector.name;
    for (const auto& [size, seen] : points) {
      series.x.push_back(size);
      series.y.push_back(seen);
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

std::vector<Chart> size_charts(const Summary& summary) {
  std::vector<Chart> charts;
  if (summary.detectors.empty()) return charts;
  const DetectorSummary& first = summary.detectors.front();
  for (const SmallestSeen& place : first.smallest) {
    const auto sizes =
        std::count_if(first.faults.begin(), first.faults.end(), [&](const FaultLine& line) {
          return line.kind == place.kind && line.joint == place.joint && line.size.has_value();
        });
    if (sizes > 1) charts.push_back(size_chart(summary, place));
  }
  return charts;
}

report::Table smallest_table(const Summary& summary) {
  report::Table table;
  table.caption = "Smallest fault that is seen in 95 % of its runs or more, as all larger ones are";
  table.columns = {{"fault", "", report::kDefaultFormat}};
  if (summary.detectors.empty()) return table;
  for (const DetectorSummary& detector : summary.detectors) {
    table.columns.push_back({detector.name, "", report::kDefaultFormat});
  }
  const std::vector<SmallestSeen>& places = summary.detectors.front().smallest;
  for (const SmallestSeen& place : places) {
    std::vector<Cell> row{place_words(place.kind, place.joint)};
    for (const DetectorSummary& detector : summary.detectors) {
      const auto same = std::find_if(detector.smallest.begin(), detector.smallest.end(),
                                     [&](const SmallestSeen& one) {
                                       return one.kind == place.kind && one.joint == place.joint;
                                     });
      if (same == detector.smallest.end()) {
        row.emplace_back("");
        continue;
      }
      const std::string size = same->size ? size_words(same->kind, same->size)
                                          : "above " + size_words(same->kind, same->largest);
      row.emplace_back(fmt::format("{} ({} of {})", size, same->seen, same->runs));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::Table confusion_table(const DetectorSummary& detector) {
  report::Table table;
  table.caption = detector.name + ": what its answers call a fault";
  table.columns = {
      {"fault", "", report::kDefaultFormat}, {"seen", "1", "d"}, {"right", "%", ".1f"}};
  for (std::size_t kind = 0; kind < offnominal::kFaultKinds; ++kind) {
    table.columns.push_back({name_of(static_cast<offnominal::FaultKind>(kind)), "1", "d"});
  }
  for (const Confusion& row : detector.confusion) {
    std::vector<Cell> cells{row.kind, static_cast<double>(row.seen)};
    cells.push_back(row.seen > 0 ? Cell(100.0 * share_of(row.right, row.seen).value)
                                 : Cell(std::monostate{}));
    for (const std::int64_t count : row.named_as) cells.emplace_back(static_cast<double>(count));
    table.rows.push_back(std::move(cells));
  }
  table.note =
      "Confusion matrix: what the fault behind a detection was called, in so many of the runs in "
      "which it was seen. The recording may end before there is an answer.";
  return table;
}

report::Table tracking_table(const DetectorSummary& detector) {
  report::Table table;
  table.caption = detector.name;
  table.columns = {{"fault", "", report::kDefaultFormat},
                   {"runs", "1", "d"},
                   {"rms without", "rad", ".5f"},
                   {"rms with", "rad", ".5f"},
                   {"with / without, median", "1", ".2f"},
                   {"95 % of runs below", "1", ".2f"},
                   {"halved", "1", "d"},
                   {"worse by 2 %", "1", "d"}};
  for (const Tracking& one : detector.tracking) {
    table.rows.push_back({one.kind, static_cast<double>(one.runs), one.without_rad, one.with_rad,
                          one.ratio_median, one.ratio_p95, static_cast<double>(one.halved),
                          static_cast<double>(one.worse)});
  }
  table.note =
      "How far the joints are off their motion in the last quarter of the time behind the fault, "
      "rms over joints: as they are, and in the same run with the monitor's compensation, which "
      "acts once it is decided that the fault is one that it is right for.";
  return table;
}

}  // namespace

report::Page page_of(const Summary& summary, const std::string& command_line) {
  report::Page page;
  page.title = "Campaign " + summary.campaign;
  const auto done = summary.runs - static_cast<std::int64_t>(summary.missing.size());
  page.subtitle =
      fmt::format("{} of {}", done, counted(static_cast<std::size_t>(summary.runs), "run"));
  page.verdict = {summary.missing.empty() ? "All runs are there." : "Runs are missing.",
                  summary.missing.empty() ? report::Level::kGood : report::Level::kWarn};
  page.command_line = command_line;
  Section alarms{.heading = "Seen and not seen", .text = "", .blocks = {}};
  if (const auto chart = roc_chart(summary)) alarms.blocks.emplace_back(*chart);
  const report::Table rates = alarms_table(summary);
  if (!rates.rows.empty()) alarms.blocks.emplace_back(rates);
  const report::Table smallest = smallest_table(summary);
  if (!smallest.rows.empty()) alarms.blocks.emplace_back(smallest);
  page.sections.push_back(std::move(alarms));
  Section sizes{.heading = "Over the size of a fault", .text = "", .blocks = {}};
  for (Chart& chart : size_charts(summary)) sizes.blocks.emplace_back(std::move(chart));
  if (!sizes.blocks.empty()) page.sections.push_back(std::move(sizes));
  Section isolation{.heading = "Which fault it is", .text = "", .blocks = {}};
  for (const DetectorSummary& detector : summary.detectors) {
    if (!detector.confusion.empty()) isolation.blocks.emplace_back(confusion_table(detector));
  }
  if (!isolation.blocks.empty()) page.sections.push_back(std::move(isolation));
  Section tracking{.heading = "Accommodated", .text = "", .blocks = {}};
  for (const DetectorSummary& detector : summary.detectors) {
    if (!detector.tracking.empty()) tracking.blocks.emplace_back(tracking_table(detector));
  }
  if (!tracking.blocks.empty()) page.sections.push_back(std::move(tracking));
  Section faults{.heading = "Fault by fault", .text = "", .blocks = {}};
  for (const DetectorSummary& detector : summary.detectors) {
    if (!detector.faults.empty()) faults.blocks.emplace_back(faults_table(detector));
  }
  if (!faults.blocks.empty()) page.sections.push_back(std::move(faults));
  return page;
}

}  // namespace offnominal::desk::campaign
