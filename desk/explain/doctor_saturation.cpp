#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "compare/standstill.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/expected_torque.hpp"
#include "explain/torque_extremes.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Rows in which the joint moves: of one that stands still friction holds a part, and its torque
// stays what it is, at no limit.
std::vector<Index> moving_rows(const Log& log, const RobotDescription& robot, Index joint) {
  constexpr double kFewest = 20;
  // Of an encoder that the file does not say, by what it shows.
  const double stated = robot.joints[static_cast<std::size_t>(joint)].encoder.counts_per_unit;
  const VectorXd q = log.q.col(joint);
  const double step = Rounding(q).at(q.cwiseAbs().maxCoeff());
  VectorXd moving = samples_in_motion(log, joint, stated > 0 ? stated : 1 / step);
  if (moving.sum() < kFewest) moving.setOnes();
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

// Torques that a drive at its limit holds, within its noise, all the time that the joint moves.
void find_held_torques(const Log& log, const RobotDescription& robot, const ExpectedTorque& model,
                       std::vector<DataFault>& faults) {
  constexpr double kHeld = 0.2;      // of the torque, that it spreads over
  constexpr double kExpected = 0.5;  // of the torque, that the model's spreads over
  constexpr double kUnlike = 3;      // times what the torque spreads over
  constexpr Index kFewestRows = 100;
  struct Held {
    Spread torque, expected;
  };
  const auto all = of_every_joint(log, [&](Index joint) -> std::optional<Held> {
    const std::vector<Index> rows = moving_rows(log, robot, joint);
    if (static_cast<Index>(rows.size()) < kFewestRows) return std::nullopt;
    const Spread torque = spread_over(rows, [&](Index row) { return log.tau(row, joint); });
    const double size = std::abs(torque.middle);
    if (!(torque.width > 0) || !(torque.width < kHeld * size)) return std::nullopt;
    const Spread expected =
        spread_over(rows, [&](Index row) { return model.at(log.t_s[row], joint); });
    if (!(expected.width > std::max(kUnlike * torque.width, kExpected * size))) return std::nullopt;
    return Held{torque, expected};
  });
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const std::optional<Held>& held = all[static_cast<std::size_t>(joint)];
    if (!held || is_known_to_stay(faults, joint)) continue;
    const Spread& torque = held->torque;
    const Spread& expected = held->expected;
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

// Whether the model asks for more while a coarse torque is at its extreme, by more than its
// rounding makes of it and than the model is wrong elsewhere.
bool is_asked_for_more(const Log& log, Index joint, const TorqueExtremes& torque, double end,
                       const ExpectedTorque& model) {
  // No more than 0.1 in a thousand recordings of no fault.
  constexpr double kSteps = 0.25;
  constexpr double kFewestInAll = 8;
  constexpr std::size_t kFewestRows = 100;
  if (torque.rows().size() < kFewestRows || !(torque.steps_in_all(end) > kFewestInAll)) {
    return false;
  }
  const std::vector<Index>& rows = torque.rows();
  const auto count = static_cast<Index>(rows.size());
  VectorXd measured(count);
  VectorXd asked(count);
  for (Index i = 0; i < count; ++i) {
    const Index row = rows[static_cast<std::size_t>(i)];
    measured[i] = log.tau(row, joint);
    asked[i] = model.at(log.t_s[row], joint);
  }
  const double middle = asked.mean();
  asked.array() -= middle;
  measured.array() -= measured.mean();
  const double size = asked.squaredNorm();
  if (!(size > 0)) return false;
  // Of a model that is too large, or has little to do with the torque, no more than follows it.
  const double scale = std::clamp(asked.dot(measured) / size, 0.0, 1.0);
  return torque.steps_beyond(end, [&](Index row) {
    return scale * (model.at(log.t_s[row], joint) - middle);
  }) > kSteps;
}

// What speaks for a limit at the extremes of a joint's torque.
struct Limits {
  double share = 0;  // of the rows in which the joint moves
  bool at_stated = false;
  bool gradual = true;
  ReachedExtreme most;
  std::vector<double> ends;
};

Limits limits_of(const Log& log, const RobotDescription& robot, Index joint,
                 const TorqueExtremes& torque, bool are_positions_right,
                 const ExpectedTorque& model) {
  // A sine spends 2 % of its time so near to its peaks, but a third as much just below.
  constexpr double kSmallestShareAtExtreme = 0.01;
  constexpr double kSmallestShareByModel = 0.02;
  constexpr double kAgainstNext = 5;
  constexpr double kAgainstNextStep = 10;
  // At the limit that the robot file states, one stretch is enough.
  constexpr Index kShortestAtLimit = 5;
  constexpr double kAtLimit = 0.98;
  constexpr double kBeyondLimit = 1.02;
  // A drive's limits are not that far apart: a joint that waits where little is asked of it stays
  // near zero, and that is the lowest value where all of its torques have one sign.
  constexpr double kSmallestOfLargest = 0.3;
  const double stated = robot.joints[static_cast<std::size_t>(joint)].joint.max_torque;
  const auto rows = static_cast<double>(torque.rows().size());
  Limits limits;
  for (const double end : torque.extremes()) {
    if (std::abs(end) < kSmallestOfLargest * torque.largest()) continue;
    const Index reached = torque.reached(end);
    const std::vector<RowSpan> stretches = torque.spans(end);
    const Index longest =
        std::max_element(stretches.begin(), stretches.end(), [](const auto& a, const auto& b) {
          return a.count() < b.count();
        })->count();
    const bool limited =
        std::abs(end) >= kAtLimit * stated && std::abs(end) <= kBeyondLimit * stated;
    // A drive has the same limit both ways; what is coarse ends at the same steps by chance.
    const bool coarse = torque.is_coarse(end) && !torque.has_extreme(-end);
    const bool flat = static_cast<double>(reached) >= (coarse ? kAgainstNextStep : kAgainstNext) *
                                                          static_cast<double>(torque.next(end) + 1);
    // A coarse torque may sit at its largest step once, and one that is told steps at any.
    const bool once =
        stretches.size() < 2 && (torque.is_coarse(end) || !torque.comes_gradually(end));
    const bool enough = static_cast<double>(reached) >= kSmallestShareAtExtreme * rows;
    const bool fine_again =
        !torque.is_coarse(end) && !torque.has_extreme(-end) && torque.holds_anywhere(end);
    const bool told =
        flat && !fine_again && ((enough && !once) || (limited && longest >= kShortestAtLimit));
    const bool often = static_cast<double>(reached) >= kSmallestShareByModel * rows;
    if (!told && !(often && are_positions_right && torque.is_coarse(end) &&
                   is_asked_for_more(log, joint, torque, end, model))) {
      continue;
    }
    if (reached > limits.most.rows) limits.most = {end, reached};
    limits.share += static_cast<double>(reached) / rows;
    limits.at_stated = limits.at_stated || limited;
    limits.gradual = limits.gradual && torque.comes_gradually(end);
    limits.ends.push_back(end);
  }
  // A drive has the same limit both ways.
  const double other = -limits.most.value;
  if (limits.ends.size() == 1 && torque.has_extreme(other)) {
    limits.ends.push_back(other);
    limits.share += static_cast<double>(torque.reached(other)) / rows;
  }
  return limits;
}

void find_reached_limits(const Log& log, const RobotDescription& robot, const ExpectedTorque& model,
                         std::vector<DataFault>& faults) {
  // Where torque is at its extremes most of the time, it may switch between two levels: dry
  // friction.
  constexpr double kLargestShareAtExtreme = 0.5;
  constexpr double kLargestShareOfAll = 0.9;
  // Of any joint: the model's torque follows from all.
  const bool are_positions_right =
      std::none_of(faults.begin(), faults.end(), [](const DataFault& fault) {
        return fault.joint >= 0 && fault.signal == FaultySignal::kPosition;
      });
  struct Reached {
    Limits limits;
    std::vector<RowSpan> spans;
  };
  const auto all = of_every_joint(log, [&](Index joint) -> std::optional<Reached> {
    const VectorXd tau = log.tau.col(joint);
    const TorqueExtremes torque(tau, moving_rows(log, robot, joint));
    if (!torque.varies()) return std::nullopt;
    Reached reached{limits_of(log, robot, joint, torque, are_positions_right, model), {}};
    if (!(reached.limits.share > 0)) return std::nullopt;
    for (const double end : reached.limits.ends) {
      const std::vector<RowSpan> stretches = torque.spans(end);
      reached.spans.insert(reached.spans.end(), stretches.begin(), stretches.end());
    }
    return reached;
  });
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const std::optional<Reached>& reached = all[static_cast<std::size_t>(joint)];
    if (!reached) continue;
    const Limits& limits = reached->limits;
    const double most_share = limits.gradual && !is_known_to_stay(faults, joint)
                                  ? kLargestShareOfAll
                                  : kLargestShareAtExtreme;
    if (limits.share > most_share && !limits.at_stated) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kSaturation;
    fault.joint = joint;
    fault.signal = FaultySignal::kTorque;
    fault.size = limits.share;
    set_spans(log, reached->spans, fault);
    fault.words =
        fmt::format("the torque of joint {} stays at {:.4g} in {:.1f} % of the samples: {}",
                    joint + 1, limits.most.value, 100 * limits.share, words_of_spans(fault));
    fault.mend = "move more gently";
    faults.push_back(std::move(fault));
  }
}

}  // namespace

void find_saturation(const Log& log, const RobotDescription& robot, const ExpectedTorque& model,
                     std::vector<DataFault>& faults) {
  find_reached_limits(log, robot, model, faults);
  find_held_torques(log, robot, model, faults);
}

}  // namespace offnominal::desk
