#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Shorter repeats cost nothing: three samples are lost in any low-pass that physics needs.
constexpr Index kShortestBurst = 3;
// A channel that repeats while it moves jumps by what it missed, then goes on at its old pace. An
// honest encoder moves on by one step, by two where it flickers.
constexpr double kJumpSteps = 3;
// After three repeats or more the jump is at least four times the change per sample; an encoder
// that stands still and is then hit keeps its new pace after the jump.
constexpr double kJumpPerChange = 2.5;
// Of what the channel missed, by how it moved before.
constexpr double kMostOfMissed = 4;
// Samples on either side of a burst that the usual change is taken from.
constexpr Index kNeighbours = 8;
// Repeats that a coarse channel would show by chance less often than this in the whole recording.
constexpr double kByChance = 1e-3;
// Bursts that a recording needs to be called stale, and their share of its rows: a single late
// packet does not spoil a fit.
constexpr std::size_t kFewestBursts = 4;
constexpr double kLeastShare = 0.002;

// A channel that the log reads faster than it is updated holds every value for about as long.
Index usual_hold(const std::vector<Burst>& bursts, Index rows) {
  if (bursts.empty()) return 0;
  Index repeated = 0;
  std::vector<Index> lengths;
  for (const Burst& burst : bursts) {
    repeated += burst.length;
    lengths.push_back(burst.length);
  }
  const Index values = rows - repeated;
  if (2 * static_cast<Index>(bursts.size()) < values) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

// Median of the changes near a burst that are none; 0 where there is no change at all.
double usual_step(const VectorXd& x, const Burst& burst) {
  constexpr Index kNear = 100;
  std::vector<double> changes;
  const Index high = std::min(burst.end() + 1 + kNear, x.size() - 1);
  for (Index i = std::max<Index>(burst.first - kNear, 0); i < high; ++i) {
    if (i >= burst.first && i <= burst.end()) continue;
    if (x[i + 1] != x[i]) changes.push_back(std::abs(x[i + 1] - x[i]));
  }
  if (changes.empty()) return 0;
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  return *middle;
}

// Median change per row on both sides of a burst, bursts left out.
double usual_change(const VectorXd& x, const Burst& burst) {
  std::vector<double> changes;
  const Index end = burst.first + burst.length;
  for (Index i = std::max<Index>(burst.first - kNeighbours, 0); i < burst.first; ++i) {
    changes.push_back(std::abs(x[i + 1] - x[i]));
  }
  const Index high = std::min(end + 1 + kNeighbours, x.size() - 1);
  for (Index i = end + 1; i < high; ++i) changes.push_back(std::abs(x[i + 1] - x[i]));
  if (changes.empty()) return std::numeric_limits<double>::infinity();
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  return *middle > 0 ? *middle : usual_step(x, burst);
}

// Mean change per row before a burst.
double change_before(const VectorXd& x, const Burst& burst) {
  const Index from = std::max<Index>(burst.first - kNeighbours, 0);
  const Index rows = burst.first - from;
  return rows > 0 ? (x.segment(from + 1, rows) - x.segment(from, rows)).cwiseAbs().mean() : 0;
}

struct Stale {
  std::vector<RowSpan> spans;  // of the rows that repeat
  Index rows = 0;
  Index longest = 0;
};

// Feedback gives the same torque as long as its encoder says the same, or little else.
bool rests(const VectorXd& q, const Rounding& rounding, const Burst& burst) {
  constexpr double kFewSteps = 3;
  const auto during = q.segment(burst.first, burst.length + 1);
  const double way = during.maxCoeff() - during.minCoeff();
  return way == 0 || way <= kFewSteps * rounding.at(during[0]);
}

// Whether a position moves on between two rows, not by a single change that is more than a step.
bool moves_steadily(const VectorXd& q, Index from, Index to, double step) {
  constexpr double kOfWay = 0.5;
  constexpr double kOneStep = 1.5;
  const double largest =
      (q.segment(from + 1, to - from) - q.segment(from, to - from)).cwiseAbs().maxCoeff();
  return largest <= kOfWay * std::abs(q[to] - q[from]) + kOneStep * step;
}

// Whether a position goes over a burst, with its jump, by about as much as it moves before and
// behind it: a joint that rests, or gives way by some steps, goes on by none, or to and fro.
bool moves_through(const VectorXd& q, const Burst& burst, double step) {
  constexpr Index kFewestRows = 3;
  const Index from = std::max<Index>(burst.first - kNeighbours, 0);
  const Index next = burst.end() + 1;
  const Index to = std::min(next + kNeighbours, q.size() - 1);
  if (burst.first - from < kFewestRows || to - next < kFewestRows) return false;
  const double before = (q[burst.first] - q[from]) / static_cast<double>(burst.first - from);
  const double behind = (q[to] - q[next]) / static_cast<double>(to - next);
  const double jump = q[next] - q[burst.end()];
  const double missed = static_cast<double>(burst.length + 1) * (before + behind) / 2;
  return moves_steadily(q, from, burst.first, step) && moves_steadily(q, next, to, step) &&
         before * behind > 0 && jump * behind > 0 &&
         std::abs(jump) < kMostOfMissed * std::abs(missed);
}

// Of a position or a torque: of a channel free of noise beyond its steps a jump must stand out.
Stale stale_of(const Log& log, Index joint, bool smooth) {
  const VectorXd q = log.q.col(joint);
  const VectorXd x = smooth ? q : log.tau.col(joint);
  const Rounding rounding(x);
  const Rounding rounding_of_q(q);
  const std::vector<Burst> bursts = repeats_of(x);
  const VectorXd passed = rows_passed(log);
  const Index hold = usual_hold(bursts, x.size());
  const std::vector<Index> repeats_before = repeats_before_of(x);
  const double low = x.minCoeff();
  const double high = x.maxCoeff();
  Stale stale;
  for (const Burst& burst : bursts) {
    const Index end = burst.first + burst.length;
    if (burst.length < kShortestBurst || burst.length <= 2 * hold || end + 1 >= x.size()) continue;
    if (is_next_to_gap(log, burst)) continue;
    // A torque at its limit repeats honestly: find_saturation().
    if (!smooth && (x[end] == low || x[end] == high || rests(q, rounding_of_q, burst))) continue;
    const double jump = std::abs(x[end + 1] - x[end]) / passed[end];
    const double step = rounding.at(x[end + 1]);
    if (jump < kJumpSteps * step) continue;
    if (smooth && !moves_through(x, burst, step)) continue;
    const bool noisy = !smooth && is_noisy_around(x, burst);
    if (!noisy && jump < kJumpPerChange * usual_change(x, burst) + 2 * step) continue;
    // What it missed is what it would have moved at that pace; a joint that stuck only starts anew.
    constexpr double kOfMissed = 0.3;
    const double missed = static_cast<double>(burst.length + 1) * usual_change(x, burst);
    if (!noisy && jump < kOfMissed * missed) continue;
    // Nor does it jump by far more than it moved before: a coarse torque that a filter, or a
    // ripple, has made fine again goes to its next step.
    const double due = static_cast<double>(burst.length + 1) * change_before(x, burst);
    if (!smooth && due > 0 && jump > kMostOfMissed * due) continue;
    if (!smooth && !noisy &&
        static_cast<double>(x.size()) *
                std::pow(own_repeats(repeats_before, burst), static_cast<double>(burst.length)) >
            kByChance) {
      continue;
    }
    stale.spans.push_back({burst.first + 1, end});
    stale.rows += burst.length;
    stale.longest = std::max(stale.longest, burst.length);
  }
  return stale;
}

}  // namespace

double smallest_step(const VectorXd& x) {
  const double rounding = 1e-12 * x.cwiseAbs().maxCoeff();
  double step = std::numeric_limits<double>::infinity();
  for (Index i = 1; i < x.size(); ++i) {
    const double change = std::abs(x[i] - x[i - 1]);
    if (change > rounding) step = std::min(step, change);
  }
  return step;
}

void find_stale_samples(const Log& log, std::vector<DataFault>& faults) {
  struct StaleSignals {
    Stale position, torque;
  };
  const std::vector<StaleSignals> all = of_every_joint(log, [&](Index joint) {
    return StaleSignals{stands_still(log.q.col(joint)) ? Stale{} : stale_of(log, joint, true),
                        stale_of(log, joint, false)};
  });
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const StaleSignals& own = all[static_cast<std::size_t>(joint)];
    for (const bool position : {true, false}) {
      const Stale& stale = position ? own.position : own.torque;
      const double share =
          static_cast<double>(stale.rows) / static_cast<double>(log.sample_count());
      if (stale.spans.size() < kFewestBursts || share < kLeastShare) continue;
      DataFault fault;
      fault.kind = DataFaultKind::kStaleSamples;
      fault.joint = joint;
      fault.signal = position ? FaultySignal::kPosition : FaultySignal::kTorque;
      fault.size = share;
      set_spans(log, stale.spans, fault);
      fault.words = fmt::format(
          "values repeat exactly while the robot moves, then jump: {} of joint {}: {:.1f} % of the "
          "rows in {} bursts; the longest burst has {} rows ({:.3g} s)",
          position ? "position" : "torque", joint + 1, 100 * share, stale.spans.size(),
          stale.longest, static_cast<double>(stale.longest) * log.period_s);
      fault.mend = "log every sample anew (look for lost packets or a blocked reader)";
      faults.push_back(std::move(fault));
    }
  }
}

void find_stuck_encoders(const Log& log, const RobotDescription& robot,
                         std::vector<DataFault>& faults) {
  // 3 degrees, or 5 cm: more than noise of a velocity adds up to on a joint that is locked.
  constexpr double kTravel = 0.05;
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const VectorXd q = log.q.col(joint);
    if (log.dq_derived[static_cast<std::size_t>(joint)] || (q.array() != q[0]).any()) continue;
    const VectorXd dq = log.dq.col(joint).array() - log.dq.col(joint).mean();
    VectorXd travel(dq.size());
    std::partial_sum(dq.begin(), dq.end(), travel.begin());
    const double moved = log.period_s * (travel.maxCoeff() - travel.minCoeff());
    if (moved < kTravel) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kStaleSamples;
    fault.joint = joint;
    fault.size = 1;
    fault.signal = FaultySignal::kPosition;
    set_spans(log, {{0, log.sample_count() - 1}}, fault);
    fault.words = fmt::format(
        "the position of {} never changes, while its velocity adds up to {:.3g} {} of travel",
        joint_words(joint), moved,
        unit_of(Quantity::kPosition, robot.joints[static_cast<std::size_t>(joint)].joint.type));
    fault.mend = "look at its encoder and at the channel that it is logged from";
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
