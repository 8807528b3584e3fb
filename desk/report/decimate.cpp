#include "report/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace offnominal::desk::report {
namespace {

struct Range {
  std::size_t begin;
  std::size_t end;
};

/// Index of the extreme finite value in the range: the lowest for sign = -1, the highest for +1.
std::optional<std::size_t> extreme(const std::vector<double>& values, Range range, double sign) {
  std::optional<std::size_t> best;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    if (std::isfinite(values[i]) && (!best || sign * values[i] > sign * values[*best])) best = i;
  }
  return best;
}

class Reducer {
 public:
  explicit Reducer(const Series& series)
      : series_(series),
        top_(series.kind == SeriesKind::kBand ? series.y_upper : series.y),
        size_(series.x.size()) {}

  std::vector<std::size_t> kept(std::size_t max_points) {
    keep(0);
    keep(size_ - 1);
    if (series_.kind == SeriesKind::kPoints) {
      keep(extreme(series_.x, {0, size_}, -1.0));
      keep(extreme(series_.x, {0, size_}, 1.0));
      keep_evenly(max_points / 2);
    }
    const std::size_t per_block = gap_in({0, size_}) ? 3 : 2;
    const std::size_t blocks = (max_points - kept_.size()) / per_block;
    for (std::size_t block = 0; block < blocks; ++block) {
      const Range range{block * size_ / blocks, (block + 1) * size_ / blocks};
      keep(extreme(series_.y, range, -1.0));
      keep(extreme(top_, range, 1.0));
      keep(gap_in(range));
    }
    std::sort(kept_.begin(), kept_.end());
    kept_.erase(std::unique(kept_.begin(), kept_.end()), kept_.end());
    return kept_;
  }

 private:
  void keep(std::optional<std::size_t> index) {
    if (index) kept_.push_back(*index);
  }

  /// Extremes alone would show a cloud as its outline.
  void keep_evenly(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) keep(i * size_ / count);
  }

  std::optional<std::size_t> gap_in(Range range) const {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      if (!std::isfinite(series_.x[i]) || !std::isfinite(series_.y[i]) || !std::isfinite(top_[i])) {
        return i;
      }
    }
    return std::nullopt;
  }

  const Series& series_;
  const std::vector<double>& top_;
  std::size_t size_;
  std::vector<std::size_t> kept_;
};

std::vector<double> pick(const std::vector<double>& values, const std::vector<std::size_t>& kept) {
  std::vector<double> picked;
  picked.reserve(kept.size());
  for (const std::size_t index : kept) picked.push_back(values[index]);
  return picked;
}

}  // namespace

Series decimate(const Series& series, std::size_t max_points) {
  if (series.kind == SeriesKind::kBars || series.x.size() <= max_points) return series;
  const std::vector<std::size_t> kept = Reducer(series).kept(max_points);
  Series reduced = series;
  reduced.x = pick(series.x, kept);
  reduced.y = pick(series.y, kept);
  if (series.kind == SeriesKind::kBand) reduced.y_upper = pick(series.y_upper, kept);
  return reduced;
}

}  // namespace offnominal::desk::report
