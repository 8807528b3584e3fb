#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

// What lies beyond the largest value that was measured, under assumptions: the largest values of
// blocks of many ticks follow a Gumbel distribution, if what they are taken from is independent,
// keeps its distribution, and has a tail that falls off like an exponential one (E. J. Gumbel,
// Statistics of Extremes, 1958). No measurement proves any of the three.

namespace offnominal::desk::wcet {

/// The largest of each block of `block_size` values, in order. An unfinished block is left out.
class BlockMaxima {
 public:
  /// block_size >= 1. Room for `blocks` is made here; later blocks are counted, not kept.
  BlockMaxima(std::int64_t block_size, std::size_t blocks);

  void record(double value);

  [[nodiscard]] std::int64_t block_size() const { return block_size_; }
  [[nodiscard]] std::span<const double> maxima() const { return maxima_; }

 private:
  std::int64_t block_size_;
  std::int64_t in_block_ = 0;
  double largest_ = 0;
  std::vector<double> maxima_;
};

/// P(maximum <= x) = exp(-exp(-(x - location) / scale)).
struct GumbelFit {
  double location = 0;
  double scale = 0;  // > 0
};

inline constexpr std::size_t kLeastMaxima = 50;

/// Of largest likelihood. None for fewer than kLeastMaxima values, or where all are the same.
[[nodiscard]] std::optional<GumbelFit> fit_gumbel(std::span<const double> maxima);

/// Largest distance between the distribution of the values and the fitted one, times the root of
/// their number.
[[nodiscard]] double kolmogorov_statistic(const GumbelFit& fit, std::span<const double> maxima);

/// The fitted distribution is rejected above it, wrongly once in 20 times (M. A. Stephens,
/// Biometrika 64(3), 1977, table for both parameters estimated).
inline constexpr double kKolmogorovLimit = 0.874;

/// What one value exceeds with probability `exceedance`, where the largest of `block_size` of them
/// follows the fit. exceedance in (0, 1).
[[nodiscard]] double exceeded_with(const GumbelFit& fit, std::int64_t block_size,
                                   double exceedance);

}  // namespace offnominal::desk::wcet
