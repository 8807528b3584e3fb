#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "compare/standstill.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/expected_torque.hpp"
#include "signal/quantile.hpp"

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
  TorqueExtremes(const VectorXd& tau, std::vector<Index> rows)
      : tau_(tau), rounding_(tau), rows_(std::move(rows)) {
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
    Index gradual = 0;
    const std::vector<RowSpan> stretches = spans(end);
    for (const RowSpan& stretch : stretches) {
      if (stretch.first == 0) continue;
      const double step = std::abs(tau_[stretch.first] - tau_[stretch.first - 1]);
      if (step < kOfRange * (high_ - low_)) ++gradual;
    }
    return 2 * gradual > static_cast<Index>(stretches.size());
  }

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
  Rounding rounding_;
  std::vector<Index> rows_;
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
  double near_ = 0;
};

// What nearly all of the values spread over.
struct Spread {
  double middle = 0;
  double width = 0;
};
Spread spread_of(const VectorXd& values) {
  constexpr double kTail = 0.05;
  return {quantile(values, 0.5), quantile(values, 1 - kTail) - quantile(values, kTail)};
}

// Over those rows of a value that each has.
template <typename ValueOf>
Spread spread_over(const std::vector<Index>& rows, const ValueOf& value_of) {
  VectorXd those(static_cast<Index>(rows.size()));
  for (Index i = 0; i < those.size(); ++i) those[i] = value_of(rows[static_cast<std::size_t>(i)]);
  return spread_of(those);
}

// Whether it is named already why a torque stays the same.
bool is_known_to_stay(const std::vector<DataFault>& faults, Index joint) {
  return std::any_of(faults.begin(), faults.end(), [joint](const DataFault& fault) {
    return fault.joint == joint && fault.signal == FaultySignal::kTorque &&
           (fault.kind == DataFaultKind::kSaturation || fault.kind == DataFaultKind::kStuck);
  });
}

}  // namespace

void find_held_torques(const Log& log, const Log& even, const RobotDescription& robot,
                       std::vector<DataFault>& faults) {
  constexpr double kHeld = 0.2;      // of the torque, that it spreads over
  constexpr double kExpected = 0.5;  // of the torque, that the model's spreads over
  constexpr double kUnlike = 3;      // times what the torque spreads over
  constexpr Index kFewestRows = 100;
  std::optional<ExpectedTorque> model;  // once a joint asks for it
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const std::vector<Index> rows = moving_rows(log, robot, joint);
    if (static_cast<Index>(rows.size()) < kFewestRows) continue;
    const Spread torque = spread_over(rows, [&](Index row) { return log.tau(row, joint); });
    const double size = std::abs(torque.middle);
    if (!(torque.width > 0) || !(torque.width < kHeld * size)) continue;
    if (!model) model.emplace(even, robot);
    const Spread expected =
        spread_over(rows, [&](Index row) { return model->at(log.t_s[row], joint); });
    if (!(expected.width > std::max(kUnlike * torque.width, kExpected * size))) continue;
    if (is_known_to_stay(faults, joint)) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kSaturation;
    fault.joint = joint;
    fault.signal = FaultySignal::kTorque;
    fault.size = 1;
    fault.words = fmt::format(
        "the torque of joint {} stays at {:.4g} within {:.2g} all the time that the joint moves, "
        "where the model's changes by {:.3g}: as a drive saturated at its limit, or one told a "
        "torque, while something else moves the joint",
        joint + 1, torque.middle, torque.width, expected.width);
    fault.mend = "move more gently, and by the drive alone";
    faults.push_back(std::move(fault));
  }
}

void find_saturation(const Log& log, const RobotDescription& robot,
                     std::vector<DataFault>& faults) {
  // A sine spends 2 % of its time so near to its peaks, but a third as much just below.
  constexpr double kSmallestShareAtExtreme = 0.01;
  constexpr double kAgainstNext = 5;
  constexpr double kAgainstNextStep = 10;
  // At the limit that the robot file states, one stretch is enough.
  constexpr Index kShortestAtLimit = 5;
  // Where torque is at its extremes most of the time, it may switch between two levels: dry
  // friction.
  constexpr double kLargestShareAtExtreme = 0.5;
  constexpr double kLargestShareOfAll = 0.9;
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
    bool gradual = true;
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
      // A drive has the same limit both ways; what is coarse ends at the same steps by chance.
      const bool coarse = torque.is_coarse(end) && !torque.has_extreme(-end);
      const bool flat =
          static_cast<double>(reached) >=
          (coarse ? kAgainstNextStep : kAgainstNext) * static_cast<double>(torque.next(end) + 1);
      // A coarse torque may sit at its largest step once, and one that is told steps at any.
      const bool once =
          stretches.size() < 2 && (torque.is_coarse(end) || !torque.comes_gradually(end));
      const bool often = !once && static_cast<double>(reached) >= kSmallestShareAtExtreme * rows;
      if (!flat || !(often || (limited && longest >= kShortestAtLimit))) continue;
      if (reached > most.rows) most = {end, reached};
      share += static_cast<double>(reached) / rows;
      at_limit = at_limit || limited;
      gradual = gradual && torque.comes_gradually(end);
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
    const double most_share =
        gradual && !is_known_to_stay(faults, joint) ? kLargestShareOfAll : kLargestShareAtExtreme;
    if (!(share > 0) || (share > most_share && !at_limit)) continue;
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
