#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace offnominal::desk::wcet {

/// How often which duration was seen: bins of 10 ns up to 100 us, of 1 us up to 100 ms, and one for
/// all beyond. 0.9 MB, however many are recorded; nothing is allocated after the constructor.
class Histogram {
 public:
  struct Bin {
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;  // not part of it
    std::uint64_t count = 0;
  };

  Histogram();

  /// A negative duration counts as 0.
  void record(std::int64_t duration_ns);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Exact; 0 where nothing was recorded.
  [[nodiscard]] std::int64_t min_ns() const { return count_ == 0 ? 0 : min_ns_; }
  [[nodiscard]] std::int64_t max_ns() const { return max_ns_; }
  [[nodiscard]] double mean_ns() const;

  /// A duration that at least the share p of all does not exceed: the end of the bin where that is
  /// reached, never below the true quantile and never above the largest one. 0 where nothing was
  /// recorded. p from 0 to 1.
  [[nodiscard]] std::int64_t quantile_ns(double p) const;

  /// The bins that are not empty, in order. The last one of all ends behind the largest duration.
  [[nodiscard]] std::vector<Bin> bins() const;

  /// The same in bins whose width grows with the duration, so many per factor of 10, from the first
  /// to the last that is not empty; those between may be.
  [[nodiscard]] std::vector<Bin> log_bins(int per_decade) const;

 private:
  static constexpr std::int64_t kFineNs = 10;
  static constexpr std::int64_t kFineEndNs = 100'000;
  static constexpr std::int64_t kCoarseNs = 1'000;
  static constexpr std::int64_t kCoarseEndNs = 100'000'000;
  static constexpr std::size_t kFineBins = kFineEndNs / kFineNs;
  static constexpr std::size_t kCoarseBins = (kCoarseEndNs - kFineEndNs) / kCoarseNs;
  static std::size_t index_of(std::int64_t duration_ns);
  [[nodiscard]] Bin bin_at(std::size_t index) const;

  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  std::int64_t min_ns_ = 0;
  std::int64_t max_ns_ = 0;
  double sum_ns_ = 0;
};

}  // namespace offnominal::desk::wcet
