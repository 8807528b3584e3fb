#include <nlohmann/json.hpp>

#include "campaign/summary_report.hpp"

namespace offnominal::desk::campaign {
namespace {

using nlohmann::ordered_json;

template <typename Value>
ordered_json or_null(const std::optional<Value>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json json_of(const Estimate& estimate) {
  return {{"value", estimate.value}, {"low_95", estimate.low}, {"high_95", estimate.high}};
}

ordered_json json_of(const std::array<std::int64_t, offnominal::kFaultKinds>& named_as) {
  ordered_json json = ordered_json::object();
  for (std::size_t kind = 0; kind < named_as.size(); ++kind) {
    json[name_of(static_cast<offnominal::FaultKind>(kind))] = named_as.at(kind);
  }
  return json;
}

ordered_json json_of(const Confusion& row) {
  return {{"kind", row.kind},
          {"seen", row.seen},
          {"right", row.right},
          {"named_as", json_of(row.named_as)}};
}

ordered_json json_of(const FaultLine& line) {
  return {{"kind", line.kind},
          {"joint", or_null(line.joint)},
          {"size", or_null(line.size)},
          {"runs", line.runs},
          {"seen", line.seen},
          {"detected", json_of(line.detected)},
          {"delay_s",
           {{"median", or_null(line.median_s)},
            {"p95", or_null(line.p95_s)},
            {"max", or_null(line.max_s)}}},
          {"joint_named", line.named},
          {"joint_right", line.joint_right},
          {"early", line.early},
          {"named_as", json_of(line.named_as)},
          {"kind_right", line.kind_right},
          {"kind_and_joint_right", line.kind_and_joint_right},
          {"size_off",
           {{"median", or_null(line.size_off_median)}, {"p90", or_null(line.size_off_p90)}}},
          {"answer_median_s", or_null(line.answer_median_s)}};
}

ordered_json json_of(const Tracking& tracking) {
  return {{"kind", tracking.kind},
          {"runs", tracking.runs},
          {"without_rad", tracking.without_rad},
          {"with_rad", tracking.with_rad},
          {"ratio", {{"median", tracking.ratio_median}, {"p95", tracking.ratio_p95}}},
          {"halved", tracking.halved},
          {"worse", tracking.worse}};
}

ordered_json json_of(const RocPoint& point) {
  return {{"threshold_scale", point.scale},
          {"false_alarms_per_hour", point.false_alarms_per_hour},
          {"detected", point.detected}};
}

ordered_json json_of(const DetectorSummary& detector) {
  ordered_json faults = ordered_json::array();
  for (const FaultLine& line : detector.faults) faults.push_back(json_of(line));
  ordered_json confusion = ordered_json::array();
  for (const Confusion& row : detector.confusion) confusion.push_back(json_of(row));
  ordered_json smallest = ordered_json::array();
  for (const SmallestSeen& one : detector.smallest) {
    smallest.push_back({{"kind", one.kind},
                        {"joint", or_null(one.joint)},
                        {"size", or_null(one.size)},
                        {"largest_tried", one.largest},
                        {"runs", one.runs},
                        {"seen", one.seen}});
  }
  ordered_json tracking = ordered_json::array();
  for (const Tracking& one : detector.tracking) tracking.push_back(json_of(one));
  ordered_json roc = ordered_json::array();
  for (const RocPoint& point : detector.roc) roc.push_back(json_of(point));
  return {
      {"name", detector.name},
      {"notes", detector.notes},
      {"faults", faults},
      {"confusion", confusion},
      {"fault_free_s", detector.fault_free_s},
      {"false_alarms", detector.false_alarms},
      {"false_alarms_per_hour",
       detector.false_alarms_per_hour ? json_of(*detector.false_alarms_per_hour) : ordered_json()},
      {"seen_in_95_of_100", smallest},
      {"accommodated", tracking},
      {"roc", roc}};
}

}  // namespace

ordered_json to_json(const Summary& summary) {
  ordered_json detectors = ordered_json::array();
  for (const DetectorSummary& detector : summary.detectors) detectors.push_back(json_of(detector));
  return {{"campaign", summary.campaign},
          {"runs", summary.runs},
          {"missing", summary.missing},
          {"detectors", detectors}};
}

}  // namespace offnominal::desk::campaign
