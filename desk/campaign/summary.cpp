#include "campaign/summary.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "common/number.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk::campaign {
namespace {

constexpr double kTail = 0.025;  // on either side of an interval
constexpr double kSeenShare = 0.95;
constexpr const char* kFaultFree = "none";

// Rows of one detector and one fault.
struct Group {
  FaultLine line;
  std::vector<double> delays_s;
  std::vector<double> sizes_off;
  std::vector<double> answers_s;
};

const FaultKindInfo* info_named(const std::string& kind) {
  for (const FaultKindInfo& info : kFaultKinds) {
    if (kind == info.name) return &info;
  }
  return nullptr;
}

void take_answer(const Result& row, const Named& named, Group& group) {
  FaultLine& line = group.line;
  ++line.named_as.at(static_cast<std::size_t>(named.kind));
  group.answers_s.push_back(named.after_s);
  const FaultKindInfo* const info = info_named(row.kind);
  if (info == nullptr || named.kind != info->answer) return;
  ++line.kind_right;
  if (info->of_joint && row.joint == named.joint + 1) ++line.kind_and_joint_right;
  if (!info->has_size_of_answer || !row.size) return;
  group.sizes_off.push_back(std::abs(named.size - *row.size) / std::abs(*row.size));
}

std::optional<double> quantile_of(const std::vector<double>& values, double at) {
  if (values.empty()) return std::nullopt;
  return quantile(
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())),
      at);
}

void take(const Result& row, Group& group) {
  FaultLine& line = group.line;
  ++line.runs;
  if (row.early) ++line.early;
  if (!row.detected) return;
  ++line.seen;
  group.delays_s.push_back(row.delay_s.value_or(0));
  if (row.named) take_answer(row, *row.named, group);
  if (!row.joint_right) return;
  ++line.named;
  if (*row.joint_right) ++line.joint_right;
}

FaultLine finished(Group group) {
  FaultLine line = std::move(group.line);
  line.detected = share_of(line.seen, line.runs);
  line.median_s = quantile_of(group.delays_s, 0.5);
  line.p95_s = quantile_of(group.delays_s, 0.95);
  line.max_s = quantile_of(group.delays_s, 1);
  line.size_off_median = quantile_of(group.sizes_off, 0.5);
  line.size_off_p90 = quantile_of(group.sizes_off, 0.9);
  line.answer_median_s = quantile_of(group.answers_s, 0.5);
  return line;
}

std::vector<Confusion> confusion_of(const std::vector<FaultLine>& lines) {
  std::vector<Confusion> rows;
  std::int64_t answers = 0;
  for (const FaultLine& line : lines) {
    auto at = std::find_if(rows.begin(), rows.end(),
                           [&](const Confusion& row) { return row.kind == line.kind; });
    if (at == rows.end()) at = rows.insert(at, Confusion{line.kind});
    at->seen += line.seen;
    at->right += line.kind_right;
    for (std::size_t kind = 0; kind < line.named_as.size(); ++kind) {
      at->named_as.at(kind) += line.named_as.at(kind);
    }
    answers += line.answers();
  }
  if (answers == 0) rows.clear();
  return rows;
}

std::vector<Tracking> tracking_of(const std::vector<const Result*>& rows) {
  std::vector<Tracking> all;
  std::vector<std::vector<double>> ratios;
  for (const Result* row : rows) {
    if (!row->tracking_end_rad || !row->tracking_end_accommodated_rad) continue;
    const double without = *row->tracking_end_rad;
    const double with = *row->tracking_end_accommodated_rad;
    const auto at = std::find_if(all.begin(), all.end(),
                                 [&](const Tracking& one) { return one.kind == row->kind; });
    const auto place = static_cast<std::size_t>(at - all.begin());
    if (at == all.end()) {
      all.push_back({row->kind});
      ratios.emplace_back();
    }
    Tracking& one = all[place];
    ++one.runs;
    if (with <= 0.5 * without) ++one.halved;
    if (with > 1.02 * without) ++one.worse;
    one.without_rad += without * without;
    one.with_rad += with * with;
    ratios[place].push_back(with / without);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    Tracking& one = all[i];
    one.without_rad = std::sqrt(one.without_rad / static_cast<double>(one.runs));
    one.with_rad = std::sqrt(one.with_rad / static_cast<double>(one.runs));
    one.ratio_median = *quantile_of(ratios[i], 0.5);
    one.ratio_p95 = *quantile_of(ratios[i], 0.95);
  }
  return all;
}

// Lines of a kind in one place stand by ascending size.
std::vector<SmallestSeen> smallest_of(const std::vector<FaultLine>& lines) {
  std::vector<SmallestSeen> all;
  std::map<std::pair<std::string, int>, std::vector<const FaultLine*>> places;
  std::vector<std::pair<std::string, int>> order;
  for (const FaultLine& line : lines) {
    if (!line.size) continue;
    const std::pair<std::string, int> place{line.kind, line.joint.value_or(0)};
    if (!places.contains(place)) order.push_back(place);
    places[place].push_back(&line);
  }
  for (const auto& place : order) {
    auto& sizes = places[place];
    // The largest first.
    std::stable_sort(sizes.begin(), sizes.end(), [](const FaultLine* x, const FaultLine* y) {
      return std::abs(*x->size) > std::abs(*y->size);
    });
    const FaultLine& largest = *sizes.front();
    SmallestSeen one{place.first, largest.joint, {}, *largest.size, largest.runs, largest.seen};
    for (const FaultLine* line : sizes) {
      if (line->detected.value < kSeenShare) break;
      one.size = line->size;
      one.runs = line->runs;
      one.seen = line->seen;
    }
    all.push_back(one);
  }
  return all;
}

void add_roc(const std::vector<const Result*>& rows, DetectorSummary& summary) {
  double hours = 0;
  std::int64_t faults = 0;
  bool has_fault_free = false;
  for (const Result* row : rows) {
    const bool fault_free = row->kind == kFaultFree;
    has_fault_free = has_fault_free || fault_free;
    hours += (fault_free ? row->judged_s : row->fault_s.value_or(0)) / 3600;
    if (!fault_free) ++faults;
  }
  if (!has_fault_free || faults == 0) return;
  summary.roc_hours = hours;
  const auto at_scale = [&](double scale) -> RocPoint {
    std::int64_t alarmed = 0;
    std::int64_t seen = 0;
    for (const Result* row : rows) {
      if (row->peak_before > scale) ++alarmed;
      if (row->kind != kFaultFree && row->peak_after > scale) ++seen;
    }
    return {scale, static_cast<double>(alarmed) / hours,
            static_cast<double>(seen) / static_cast<double>(faults)};
  };
  constexpr int kPerDecade = 30;
  double highest = 0;
  for (const Result* row : rows) highest = std::max(highest, row->peak_before);
  for (int i = -2 * kPerDecade; i <= kPerDecade; ++i) {
    summary.roc.push_back(at_scale(std::pow(10.0, static_cast<double>(i) / kPerDecade)));
  }
  if (std::isfinite(highest)) summary.without_false_alarm = at_scale(highest);
}

DetectorSummary summary_of_one(const DetectorRow& detector,
                               const std::vector<const Result*>& rows) {
  using Key = std::tuple<std::string, int, double>;
  DetectorSummary summary;
  summary.name = detector.name;
  summary.notes = detector.notes;
  std::map<Key, std::size_t> places;
  std::vector<Group> groups;  // in the order of the runs, which is the file's
  for (const Result* row : rows) {
    if (row->kind == kFaultFree) {
      summary.fault_free_s += row->judged_s;
      summary.false_alarms += row->alarms;
      continue;
    }
    const Key key{row->kind, row->joint.value_or(0), row->size.value_or(0)};
    const auto [at, is_new] = places.try_emplace(key, groups.size());
    if (is_new) {
      Group& group = groups.emplace_back();
      group.line.kind = row->kind;
      group.line.joint = row->joint;
      group.line.size = row->size;
    }
    take(*row, groups[at->second]);
  }
  for (Group& group : groups) summary.faults.push_back(finished(std::move(group)));
  if (summary.fault_free_s > 0) {
    summary.false_alarms_per_hour = rate_of(summary.false_alarms, summary.fault_free_s / 3600);
  }
  summary.smallest = smallest_of(summary.faults);
  summary.confusion = confusion_of(summary.faults);
  summary.tracking = tracking_of(rows);
  add_roc(rows, summary);
  return summary;
}

}  // namespace

std::int64_t FaultLine::answers() const {
  return std::accumulate(named_as.begin(), named_as.end(), std::int64_t{0});
}

Estimate share_of(std::int64_t hits, std::int64_t of) {
  using boost::math::binomial_distribution;
  const auto k = static_cast<double>(hits);
  const auto n = static_cast<double>(of);
  // Its ends have no quantile.
  const double low = hits == 0 ? 0 : binomial_distribution<>::find_lower_bound_on_p(n, k, kTail);
  const double high = hits == of ? 1 : binomial_distribution<>::find_upper_bound_on_p(n, k, kTail);
  return {k / n, low, high};
}

Estimate rate_of(std::int64_t count, double hours) {
  const auto k = static_cast<double>(count);
  const double low = count == 0 ? 0 : boost::math::gamma_p_inv(k, kTail);
  const double high = boost::math::gamma_q_inv(k + 1, kTail);
  return {k / hours, low / hours, high / hours};
}

Summary summary_of(const Results& results) {
  Summary summary{results.campaign.name, results.campaign.runs, results.missing, {}};
  for (const DetectorRow& detector : results.campaign.detectors) {
    std::vector<const Result*> rows;
    for (const Result& row : results.rows) {
      if (row.detector == detector.name) rows.push_back(&row);
    }
    summary.detectors.push_back(summary_of_one(detector, rows));
  }
  return summary;
}

std::string place_words(const std::string& kind, const std::optional<int>& joint) {
  if (!joint) return kind;
  return fmt::format("{}, {} {}", kind, kind == "push" ? "link" : "joint", *joint);
}

std::string size_words(const std::string& kind, const std::optional<double>& size) {
  if (!size) return {};
  const FaultKindInfo* const info = info_named(kind);
  if (info == nullptr) return shortest(*size);
  // A share.
  if (std::string(info->unit) == "1") return fmt::format("{:.6g} %", 100 * *size);
  return shortest(*size) + " " + info->unit;
}

}  // namespace offnominal::desk::campaign
