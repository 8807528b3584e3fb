#include "wcet/histogram.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::desk::wcet {

Histogram::Histogram() : counts_(kFineBins + kCoarseBins + 1) {}

std::size_t Histogram::index_of(std::int64_t duration_ns) {
  if (duration_ns < kFineEndNs) return static_cast<std::size_t>(duration_ns / kFineNs);
  if (duration_ns >= kCoarseEndNs) return kFineBins + kCoarseBins;
  return kFineBins + static_cast<std::size_t>((duration_ns - kFineEndNs) / kCoarseNs);
}

Histogram::Bin Histogram::bin_at(std::size_t index) const {
  const auto i = static_cast<std::int64_t>(index);
  if (index < kFineBins) return {i * kFineNs, (i + 1) * kFineNs, counts_[index]};
  const std::int64_t begin = kFineEndNs + (i - static_cast<std::int64_t>(kFineBins)) * kCoarseNs;
  const bool last = index == kFineBins + kCoarseBins;
  return {begin, last ? std::max(begin, max_ns_) + 1 : begin + kCoarseNs, counts_[index]};
}

void Histogram::record(std::int64_t duration_ns) {
  const std::int64_t duration = std::max<std::int64_t>(duration_ns, 0);
  ++counts_[index_of(duration)];
  min_ns_ = count_ == 0 ? duration : std::min(min_ns_, duration);
  max_ns_ = std::max(max_ns_, duration);
  sum_ns_ += static_cast<double>(duration);
  ++count_;
}

double Histogram::mean_ns() const {
  return count_ == 0 ? 0 : sum_ns_ / static_cast<double>(count_);
}

std::int64_t Histogram::quantile_ns(double p) const {
  if (count_ == 0) return 0;
  const double wanted = std::ceil(std::clamp(p, 0.0, 1.0) * static_cast<double>(count_));
  const auto needed = std::max<std::uint64_t>(static_cast<std::uint64_t>(wanted), 1);
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    below += counts_[i];
    if (below >= needed) return std::min(bin_at(i).end_ns, max_ns_);
  }
  return max_ns_;
}

std::vector<Histogram::Bin> Histogram::bins() const {
  std::vector<Bin> result;
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] > 0) result.push_back(bin_at(i));
  }
  return result;
}

std::vector<Histogram::Bin> Histogram::log_bins(int per_decade) const {
  const std::vector<Bin> fine = bins();
  if (fine.empty()) return {};
  // Edges fall on those of the fine bins, so that every fine bin belongs to one wide one.
  const auto edge = [per_decade](int k) {
    const double exact = std::pow(10.0, static_cast<double>(k) / per_decade);
    const std::int64_t step = exact < static_cast<double>(kFineEndNs) ? kFineNs : kCoarseNs;
    return std::max<std::int64_t>(std::llround(exact / static_cast<double>(step)) * step, kFineNs);
  };
  int k = per_decade;  // 10 ns: below it there is one fine bin
  while (edge(k + 1) <= fine.front().begin_ns) ++k;
  std::vector<Bin> result;
  std::size_t next = 0;
  if (fine.front().begin_ns < kFineNs) {
    result.push_back({0, kFineNs, fine.front().count});
    next = 1;
  }
  while (next < fine.size()) {
    const std::int64_t begin = edge(k);
    ++k;
    if (edge(k) == begin) continue;
    Bin wide{begin, edge(k), 0};
    for (; next < fine.size() && fine[next].begin_ns < wide.end_ns; ++next) {
      wide.count += fine[next].count;
    }
    result.push_back(wide);
  }
  // The bin of what is longer than all others has no width of its own.
  result.back().end_ns = std::max(result.back().end_ns, fine.back().end_ns);
  return result;
}

}  // namespace offnominal::desk::wcet
