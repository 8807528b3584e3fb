#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "explain/doctor_signal.hpp"
#include "log/log.hpp"

namespace offnominal::desk {

// The largest and the smallest torque of a joint, in the rows that count, and how it comes to them.
// `tau`, N m or N, must outlive it.
class TorqueExtremes {
 public:
  TorqueExtremes(const Eigen::VectorXd& tau, std::vector<Eigen::Index> rows)
      : tau_(tau), rounding_(tau), rows_(std::move(rows)) {
    for (const Eigen::Index i : rows_) {
      low_ = std::min(low_, tau[i]);
      high_ = std::max(high_, tau[i]);
    }
    // An extreme value counts as reached within this share of the torque's range.
    constexpr double kNearExtreme = 1e-3;
    near_ = kNearExtreme * (high_ - low_);
  }

  [[nodiscard]] bool varies() const { return high_ > low_; }
  [[nodiscard]] double largest() const { return std::max(std::abs(low_), std::abs(high_)); }
  // Those that may be limits: what is nearest to zero of torques of one sign is none.
  [[nodiscard]] std::vector<double> extremes() const {
    std::vector<double> ends;
    if (low_ < 0) ends.push_back(low_);
    if (high_ > 0) ends.push_back(high_);
    return ends;
  }
  [[nodiscard]] const std::vector<Eigen::Index>& rows() const { return rows_; }

  [[nodiscard]] Eigen::Index reached(double end) const { return within(end, near_); }

  // By how much what is expected goes further beyond a coarse torque's extreme than beyond the step
  // below it, on the average and less the deviation of that, in such steps. Rounding alone makes at
  // most half a step of it.
  template <typename Expected>
  [[nodiscard]] double steps_beyond(double end, const Expected& expected) const {
    const double step = rounding_.at(end);
    std::vector<double> beyond;
    std::vector<double> below;
    for (const Eigen::Index i : rows_) {
      const double distance = std::abs(tau_[i] - end);
      if (distance > near_ + 1.5 * step) continue;
      (distance <= near_ ? beyond : below)
          .push_back(std::copysign(1.0, end) * (expected(i) - tau_[i]));
    }
    if (beyond.empty() || below.empty() || !(step > 0)) return 0;
    const auto values_of = [](const std::vector<double>& values) {
      return Eigen::Map<const Eigen::VectorXd>(values.data(),
                                               static_cast<Eigen::Index>(values.size()));
    };
    const auto variance = [](const auto& values) {
      return (values.array() - values.mean()).square().mean();
    };
    const auto at_end = values_of(beyond);
    const auto next = values_of(below);
    // Neighbours are not independent: as many values as there are stretches.
    const double deviation =
        std::sqrt((variance(at_end) + variance(next)) / static_cast<double>(spans(end).size()));
    return (at_end.mean() - next.mean() - deviation) / step;
  }

  // How many of its steps a coarse torque spreads over.
  [[nodiscard]] double steps_in_all(double end) const { return (high_ - low_) / rounding_.at(end); }
  // The rows in the band below, with the next value that a coarse torque has: in any motion there
  // are about as many of them.
  [[nodiscard]] Eigen::Index next(double end) const {
    const double band = is_coarse(end) ? std::max(2 * near_, 1.5 * to_next(end)) : 2 * near_;
    return within(end, band) - reached(end);
  }
  [[nodiscard]] bool has_extreme(double value) const {
    return std::abs(value - low_) <= near_ || std::abs(value - high_) <= near_;
  }
  // Of a torque that is not rounded the value below an extreme may be far off too, where it is left
  // steeply.
  [[nodiscard]] bool is_coarse(double end) const {
    return rounding_.at(end) > near_ && to_next(end) > 2 * near_;
  }

  // Whether it comes to an extreme by and by, mostly: what switches between two levels jumps there.
  [[nodiscard]] bool comes_gradually(double end) const {
    constexpr double kOfRange = 0.3;
    Eigen::Index gradual = 0;
    const std::vector<RowSpan> stretches = spans(end);
    for (const RowSpan& stretch : stretches) {
      if (stretch.first == 0) continue;
      const double step = std::abs(tau_[stretch.first] - tau_[stretch.first - 1]);
      if (step < kOfRange * (high_ - low_)) ++gradual;
    }
    return 2 * gradual > static_cast<Eigen::Index>(stretches.size());
  }

  // Whether it stays at one value for some rows as often anywhere between its extremes: a coarse
  // torque that a filter, or noise, has made fine again.
  [[nodiscard]] bool holds_anywhere(double end) const {
    constexpr std::size_t kFewestRows = 5;
    constexpr double kStep = 5;  // times what counts as reached, within as many rows
    Eigen::Index held = 0;
    std::size_t run = 1;
    for (std::size_t k = 1; k + kFewestRows < rows_.size(); ++k) {
      const double value = tau_[rows_[k - 1]];
      if (rows_[k] == rows_[k - 1] + 1 && std::abs(tau_[rows_[k]] - value) <= near_ / 10) {
        ++run;
        continue;
      }
      const bool steps = std::abs(tau_[rows_[k + kFewestRows]] - value) > kStep * near_;
      if (run >= kFewestRows && steps && !has_extreme(value))
        held += static_cast<Eigen::Index>(run);
      run = 1;
    }
    return held > reached(end);
  }

  // Stretches of rows at an extreme, with the few between them in which it comes off it.
  [[nodiscard]] std::vector<RowSpan> spans(double end) const {
    constexpr Eigen::Index kBetween = 3;
    std::vector<RowSpan> found;
    for (const Eigen::Index i : rows_) {
      if (std::abs(tau_[i] - end) > near_) continue;
      if (!found.empty() && i - found.back().last <= kBetween) {
        found.back().last = i;
      } else {
        found.push_back({i, i});
      }
    }
    return found;
  }

 private:
  [[nodiscard]] Eigen::Index within(double end, double distance) const {
    return std::count_if(rows_.begin(), rows_.end(),
                         [&](Eigen::Index i) { return std::abs(tau_[i] - end) <= distance; });
  }

  [[nodiscard]] double to_next(double end) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Index i : rows_) {
      const double distance = std::abs(tau_[i] - end);
      if (distance > near_) least = std::min(least, distance);
    }
    return least;
  }

  const Eigen::VectorXd& tau_;
  Rounding rounding_;
  std::vector<Eigen::Index> rows_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
  double near_ = 0;
};

}  // namespace offnominal::desk
