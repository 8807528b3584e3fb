#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "compare/standstill.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Rows in which the joint moves: of one that stands still friction holds a part, and its torque
// stays what it is, at no limit.
std::vector<Index> moving_rows(const Log& log, const RobotDescription& robot, Index joint) {
  VectorXd moving = moving_samples(
      log, joint, robot.joints[static_cast<std::size_t>(joint)].encoder.counts_per_unit);
  for (const RowSpan& gap : log.gaps) moving.segment(gap.first, gap.count()).setZero();
  std::vector<Index> rows;
  for (Index i = 0; i < moving.size(); ++i) {
    if (moving[i] > 0) rows.push_back(i);
  }
  return rows;
}

// A torque at one of its extremes.
struct ReachedExtreme {
  double value = 0;
  Index rows = 0;
};

class TorqueExtremes {
 public:
  TorqueExtremes(const VectorXd& tau, std::vector<Index> rows) : tau_(tau), rows_(std::move(rows)) {
    for (const Index i : rows_) {
      low_ = std::min(low_, tau[i]);
      high_ = std::max(high_, tau[i]);
    }
    // An extreme value counts as reached within this share of the torque's range.
    constexpr double kNearExtreme = 1e-3;
    near_ = kNearExtreme * (high_ - low_);
  }

  [[nodiscard]] bool varies() const { return high_ > low_; }
  [[nodiscard]] double largest() const { return std::max(std::abs(low_), std::abs(high_)); }
  [[nodiscard]] auto extremes() const { return std::vector<double>{low_, high_}; }
  [[nodiscard]] Index rows() const { return static_cast<Index>(rows_.size()); }

  [[nodiscard]] Index reached(double end) const { return within(end, near_); }
  // The rows in the band below, with the next value that a coarse torque has: in any motion there
  // are about as many of them.
  [[nodiscard]] Index next(double end) const {
    return within(end, std::max(2 * near_, 1.5 * to_next(end))) - reached(end);
  }
  [[nodiscard]] bool has_extreme(double value) const {
    return std::abs(value - low_) <= near_ || std::abs(value - high_) <= near_;
  }
  [[nodiscard]] bool is_coarse(double end) const { return to_next(end) > 2 * near_; }

  // Stretches of rows at an extreme, with the few between them in which it comes off it.
  [[nodiscard]] std::vector<RowSpan> spans(double end) const {
    constexpr Index kBetween = 3;
    std::vector<RowSpan> found;
    for (const Index i : rows_) {
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
  [[nodiscard]] Index within(double end, double distance) const {
    return std::count_if(rows_.begin(), rows_.end(),
                         [&](Index i) { return std::abs(tau_[i] - end) <= distance; });
  }

  [[nodiscard]] double to_next(double end) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Index i : rows_) {
      const double distance = std::abs(tau_[i] - end);
      if (distance > near_) least = std::min(least, distance);
    }
    return least;
  }

  const VectorXd& tau_;
  std::vector<Index> rows_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
  double near_ = 0;
};

}  // namespace

void find_saturation(const Log& log, const RobotDescription& robot,
                     std::vector<DataFault>& faults) {
  // A sine spends 2 % of its time so near to its peaks, but a third as much just below.
  constexpr double kSmallestShareAtExtreme = 0.01;
  constexpr double kAgainstNext = 5;
  constexpr double kAgainstNextStep = 10;
  // At the limit that the robot file states, one stretch is enough.
  constexpr Index kShortestAtLimit = 5;
  // Where torque is at its extremes most of the time, it switches between two levels: dry friction.
  constexpr double kLargestShareAtExtreme = 0.5;
  constexpr double kAtLimit = 0.98;
  constexpr double kBeyondLimit = 1.02;
  // A drive's limits are not that far apart: a joint that waits where little is asked of it stays
  // near zero, and that is the lowest value where all of its torques have one sign.
  constexpr double kSmallestOfLargest = 0.3;
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const VectorXd tau = log.tau.col(joint);
    const TorqueExtremes torque(tau, moving_rows(log, robot, joint));
    if (!torque.varies()) continue;
    const double limit = robot.joints[static_cast<std::size_t>(joint)].joint.max_torque;
    const auto rows = static_cast<double>(torque.rows());
    double share = 0;
    bool at_limit = false;
    int extremes_reached = 0;
    ReachedExtreme most;
    std::vector<RowSpan> spans;
    for (const double end : torque.extremes()) {
      if (std::abs(end) < kSmallestOfLargest * torque.largest()) continue;
      const Index reached = torque.reached(end);
      const std::vector<RowSpan> stretches = torque.spans(end);
      const Index longest =
          std::max_element(stretches.begin(), stretches.end(), [](const auto& a, const auto& b) {
            return a.count() < b.count();
          })->count();
      const bool limited =
          std::abs(end) >= kAtLimit * limit && std::abs(end) <= kBeyondLimit * limit;
      const bool flat = static_cast<double>(reached) >=
                        (torque.is_coarse(end) ? kAgainstNextStep : kAgainstNext) *
                            static_cast<double>(torque.next(end) + 1);
      // A coarse torque may sit at its largest step once.
      const bool once = torque.is_coarse(end) && stretches.size() < 2;
      const bool often = !once && static_cast<double>(reached) >= kSmallestShareAtExtreme * rows;
      if (!flat || !(often || (limited && longest >= kShortestAtLimit))) continue;
      if (reached > most.rows) most = {end, reached};
      share += static_cast<double>(reached) / rows;
      at_limit = at_limit || limited;
      ++extremes_reached;
      spans.insert(spans.end(), stretches.begin(), stretches.end());
    }
    // A drive has the same limit both ways.
    const double other = -most.value;
    if (most.rows > 0 && extremes_reached < 2 && torque.has_extreme(other)) {
      const std::vector<RowSpan> stretches = torque.spans(other);
      spans.insert(spans.end(), stretches.begin(), stretches.end());
      share += static_cast<double>(torque.reached(other)) / rows;
    }
    if (!(share > 0) || (share > kLargestShareAtExtreme && !at_limit)) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kSaturation;
    fault.joint = joint;
    fault.signal = FaultySignal::kTorque;
    fault.size = share;
    set_spans(log, spans, fault);
    fault.words =
        fmt::format("the torque of joint {} stays at {:.4g} in {:.1f} % of the samples: {}",
                    joint + 1, most.value, 100 * share, words_of_spans(fault));
    fault.mend = "move more gently";
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
