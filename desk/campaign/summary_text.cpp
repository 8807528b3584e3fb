#include <fmt/format.h>

#include <utility>

#include "campaign/summary_report.hpp"
#include "common/amount.hpp"
#include "common/text_table.hpp"

namespace offnominal::desk::campaign {
namespace {

std::string seconds(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f}", *value) : "-";
}

std::string faults_text(const DetectorSummary& detector) {
  if (detector.faults.empty()) return {};
  const TextTable table({{"fault", -24},
                         {"size", -10},
                         {"runs", 5},
                         {"seen %", 7},
                         {"95 % interval", 14},
                         {"median s", 9},
                         {"p95 s", 7},
                         {"max s", 7},
                         {"joint right", 12},
                         {"early", 6}},
                        "  ");
  std::string text = table.heading();
  for (const FaultLine& line : detector.faults) {
    const std::string right =
        line.named == 0 ? "-" : fmt::format("{} of {}", line.joint_right, line.named);
    text += table.row(
        place_words(line.kind, line.joint), size_words(line.kind, line.size), line.runs,
        fmt::format("{:.1f}", 100 * line.detected.value),
        fmt::format("{:.1f} to {:.1f}", 100 * line.detected.low, 100 * line.detected.high),
        seconds(line.median_s), seconds(line.p95_s), seconds(line.max_s), right, line.early);
  }
  return text;
}

// Planted faults down, answers across.
std::string confusion_text(const DetectorSummary& detector) {
  if (detector.confusion.empty()) return {};
  std::vector<TextColumn> columns{{"which fault it is", -24}, {"seen", 5}, {"right %", 8}};
  for (std::size_t kind = 0; kind < offnominal::kFaultKinds; ++kind) {
    const std::string name = name_of(static_cast<offnominal::FaultKind>(kind));
    columns.push_back({name, static_cast<int>(name.size()) + 1});
  }
  const TextTable table(std::move(columns), "  ");
  std::string text = table.heading();
  for (const Confusion& row : detector.confusion) {
    std::vector<std::string> cells{row.kind, std::to_string(row.seen), "-"};
    if (row.seen > 0) cells[2] = fmt::format("{:.1f}", 100.0 * share_of(row.right, row.seen).value);
    for (const std::int64_t count : row.named_as) cells.push_back(std::to_string(count));
    text += table.line(cells);
  }
  return text;
}

std::string answers_text(const DetectorSummary& detector) {
  if (detector.confusion.empty()) return {};
  const TextTable table({{"its answers", -24},
                         {"size", -10},
                         {"seen", 5},
                         {"kind", 5},
                         {"and joint", 10},
                         {"size off %", 11},
                         {"p90 %", 6},
                         {"after s", 8}},
                        "  ");
  std::string text = table.heading();
  const auto percent = [](const std::optional<double>& share) {
    return share ? fmt::format("{:.1f}", 100 * *share) : std::string("-");
  };
  for (const FaultLine& line : detector.faults) {
    if (line.answers() == 0) continue;
    text += table.row(
        place_words(line.kind, line.joint), size_words(line.kind, line.size), line.seen,
        line.kind_right,
        line.joint && line.kind != "push" ? std::to_string(line.kind_and_joint_right) : "-",
        percent(line.size_off_median), percent(line.size_off_p90), seconds(line.answer_median_s));
  }
  return text;
}

std::string tracking_text(const DetectorSummary& detector) {
  if (detector.tracking.empty()) return {};
  const TextTable table({{"accommodated", -24},
                         {"runs", 5},
                         {"rms rad", 9},
                         {"with", 9},
                         {"ratio", 7},
                         {"p95", 7},
                         {"halved", 7},
                         {"worse", 6}},
                        "  ");
  std::string text = table.heading();
  for (const Tracking& one : detector.tracking) {
    text += table.row(one.kind, one.runs, fmt::format("{:.5f}", one.without_rad),
                      fmt::format("{:.5f}", one.with_rad), fmt::format("{:.2f}", one.ratio_median),
                      fmt::format("{:.2f}", one.ratio_p95), one.halved, one.worse);
  }
  return text;
}

std::string false_alarms_text(const DetectorSummary& detector) {
  if (!detector.false_alarms_per_hour) return "  no fault-free runs\n";
  const Estimate& rate = *detector.false_alarms_per_hour;
  return fmt::format("  fault-free: {} in {:.4g} h, {:.3g} per hour (95 %: {:.3g} to {:.3g})\n",
                     counted(static_cast<std::size_t>(detector.false_alarms), "false alarm"),
                     detector.fault_free_s / 3600, rate.value, rate.low, rate.high);
}

std::string quiet_text(const DetectorSummary& detector) {
  if (!detector.without_false_alarm) return {};
  const RocPoint& quiet = *detector.without_false_alarm;
  return fmt::format(
      "  thresholds times {:.3g} have no alarm in the {:.3g} h without a fault and see {:.1f} % of "
      "all runs with one\n",
      quiet.scale, detector.roc_hours, 100 * quiet.detected);
}

std::string smallest_text(const DetectorSummary& detector) {
  std::string text;
  for (const SmallestSeen& one : detector.smallest) {
    const std::string size = one.size ? "from " + size_words(one.kind, one.size)
                                      : "not even " + size_words(one.kind, one.largest);
    text += fmt::format("  seen in 95 % of the runs: {} {} ({} of {} runs)\n",
                        place_words(one.kind, one.joint), size, one.seen, one.runs);
  }
  return text;
}

}  // namespace

std::string text_of(const Summary& summary) {
  std::string text = fmt::format("campaign {}: {} of {}\n", summary.campaign,
                                 summary.runs - static_cast<std::int64_t>(summary.missing.size()),
                                 counted(static_cast<std::size_t>(summary.runs), "run"));
  if (!summary.missing.empty()) {
    text += fmt::format("missing: {} ({})\n", counted(summary.missing.size(), "run"),
                        run_list(summary.missing));
  }
  for (const DetectorSummary& detector : summary.detectors) {
    text += fmt::format("\n{}\n", detector.name);
    text += faults_text(detector) + false_alarms_text(detector) + quiet_text(detector) +
            smallest_text(detector) + confusion_text(detector) + answers_text(detector) +
            tracking_text(detector);
    if (!detector.notes.empty()) text += "  note: " + detector.notes + "\n";
  }
  return text;
}

}  // namespace offnominal::desk::campaign
