#include "wcet/extreme_value.hpp"

#include <algorithm>
#include <boost/math/distributions/extreme_value.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <numeric>

namespace offnominal::desk::wcet {
namespace {

struct Moments {
  double mean = 0;
  double deviation = 0;
  double least = 0;
};

Moments moments_of(std::span<const double> values) {
  Moments m;
  const auto n = static_cast<double>(values.size());
  m.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  for (const double x : values) m.deviation += (x - m.mean) * (x - m.mean);
  m.deviation = std::sqrt(m.deviation / (n - 1));
  m.least = *std::min_element(values.begin(), values.end());
  return m;
}

// Sums of exp(-(x - least) / scale), plain and weighted with x: no exponent is above 0.
struct WeightedSums {
  double plain = 0;
  double weighted = 0;
};
WeightedSums sums_at(std::span<const double> values, double least, double scale) {
  WeightedSums sums;
  for (const double x : values) {
    const double weight = std::exp(-(x - least) / scale);
    sums.plain += weight;
    sums.weighted += x * weight;
  }
  return sums;
}

}  // namespace

BlockMaxima::BlockMaxima(std::int64_t block_size, std::size_t blocks)
    : block_size_(std::max<std::int64_t>(block_size, 1)) {
  maxima_.reserve(blocks);
}

void BlockMaxima::record(double value) {
  largest_ = in_block_ == 0 ? value : std::max(largest_, value);
  if (++in_block_ < block_size_) return;
  in_block_ = 0;
  if (maxima_.size() < maxima_.capacity()) maxima_.push_back(largest_);
}

std::optional<GumbelFit> fit_gumbel(std::span<const double> maxima) {
  if (maxima.size() < kLeastMaxima) return std::nullopt;
  const Moments m = moments_of(maxima);
  if (!(m.deviation > 0)) return std::nullopt;
  // The likelihood's one equation for the scale (it rises through 0), then the location from it.
  const auto equation = [&](double scale) {
    const WeightedSums sums = sums_at(maxima, m.least, scale);
    return scale - m.mean + sums.weighted / sums.plain;
  };
  double low = m.deviation * 1e-3;
  double high = m.deviation;
  while (equation(high) < 0) high *= 2;
  while (equation(low) > 0) low /= 2;
  std::uintmax_t iterations = 200;
  const auto bracket = boost::math::tools::toms748_solve(
      equation, low, high, boost::math::tools::eps_tolerance<double>(45), iterations);
  const double scale = 0.5 * (bracket.first + bracket.second);
  const double mean_weight =
      sums_at(maxima, m.least, scale).plain / static_cast<double>(maxima.size());
  return GumbelFit{m.least - scale * std::log(mean_weight), scale};
}

double kolmogorov_statistic(const GumbelFit& fit, std::span<const double> maxima) {
  std::vector<double> sorted(maxima.begin(), maxima.end());
  std::sort(sorted.begin(), sorted.end());
  const boost::math::extreme_value_distribution<double> gumbel(fit.location, fit.scale);
  const auto n = static_cast<double>(sorted.size());
  double distance = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const double expected = boost::math::cdf(gumbel, sorted[i]);
    const auto rank = static_cast<double>(i);
    distance = std::max({distance, (rank + 1) / n - expected, expected - rank / n});
  }
  return distance * std::sqrt(n);
}

double exceeded_with(const GumbelFit& fit, std::int64_t block_size, double exceedance) {
  // Of a block: 1 - (1 - exceedance)^size, without its rounding.
  const double of_block = -std::expm1(static_cast<double>(block_size) * std::log1p(-exceedance));
  const boost::math::extreme_value_distribution<double> gumbel(fit.location, fit.scale);
  return boost::math::quantile(boost::math::complement(gumbel, of_block));
}

}  // namespace offnominal::desk::wcet
