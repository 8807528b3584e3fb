#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "explain/doctor_checks.hpp"

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
// Samples on either side of a burst that the usual change is taken from.
constexpr Index kNeighbours = 8;
// Samples on either side that tell how often this channel repeats a value of its own accord.
constexpr Index kSurroundings = 100;
// Repeats that a coarse channel would show by chance less often than this in the whole recording.
constexpr double kByChance = 1e-3;
// Bursts that a recording needs to be called stale, and their share of its rows: a single late
// packet does not spoil a fit.
constexpr std::size_t kFewestBursts = 4;
constexpr double kSmallestShare = 0.002;

struct Burst {
  Index first = 0;   // row that holds the value first
  Index length = 0;  // rows that repeat it
};

std::vector<Burst> repeats_of(const VectorXd& x) {
  std::vector<Burst> bursts;
  for (Index i = 1; i < x.size(); ++i) {
    if (x[i] != x[i - 1]) continue;
    if (bursts.empty() || bursts.back().first + bursts.back().length != i - 1) {
      bursts.push_back({i - 1, 0});
    }
    ++bursts.back().length;
  }
  return bursts;
}

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

// Share of rows around a burst that repeat the row before them, at most: two standard errors up.
double own_repeats(const std::vector<Index>& repeats_before, const Burst& burst) {
  const auto rows = static_cast<Index>(repeats_before.size());
  const Index end = burst.first + burst.length;
  const Index low = std::max<Index>(burst.first - kSurroundings, 0);
  const Index high = std::min(end + 1 + kSurroundings, rows - 1);
  const auto count = [&](Index from, Index to) {
    return static_cast<double>(repeats_before[static_cast<std::size_t>(to)] -
                               repeats_before[static_cast<std::size_t>(from)]);
  };
  const auto around = static_cast<double>((burst.first - low) + (high - end));
  if (around < 1) return 1;
  const double share = (count(low, burst.first) + count(end, high)) / around;
  return std::min(1.0, share + 2 * std::sqrt(share * (1 - share) / around) + 3 / around);
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
  return *middle;
}

struct Stale {
  std::size_t bursts = 0;
  Index rows = 0;
  Index longest = 0;
};

// `smooth`: the channel is free of noise beyond its steps, so that a jump must stand out.
Stale stale_of(const VectorXd& x, bool smooth) {
  const double step = smallest_step(x);
  const std::vector<Burst> bursts = repeats_of(x);
  const Index hold = usual_hold(bursts, x.size());
  std::vector<Index> repeats_before(static_cast<std::size_t>(x.size()), 0);
  for (Index i = 1; i < x.size(); ++i) {
    repeats_before[static_cast<std::size_t>(i)] =
        repeats_before[static_cast<std::size_t>(i - 1)] + (x[i] == x[i - 1] ? 1 : 0);
  }
  const double low = x.minCoeff();
  const double high = x.maxCoeff();
  Stale stale;
  for (const Burst& burst : bursts) {
    const Index end = burst.first + burst.length;
    if (burst.length < kShortestBurst || burst.length <= 2 * hold || end + 1 >= x.size()) continue;
    // A torque at its limit repeats honestly: find_saturation().
    if (!smooth && (x[end] == low || x[end] == high)) continue;
    const double jump = std::abs(x[end + 1] - x[end]);
    if (jump < kJumpSteps * step) continue;
    if (smooth && jump < kJumpPerChange * usual_change(x, burst) + 2 * step) continue;
    if (!smooth && static_cast<double>(x.size()) * std::pow(own_repeats(repeats_before, burst),
                                                            static_cast<double>(burst.length)) >
                       kByChance) {
      continue;
    }
    ++stale.bursts;
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
  struct Found {
    Index joint;
    bool position;
    Stale stale;
  };
  std::vector<Found> found;
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    for (const bool position : {true, false}) {
      const VectorXd x = position ? log.q.col(joint) : log.tau.col(joint);
      const Stale stale = stale_of(x, position);
      if (stale.bursts < kFewestBursts ||
          static_cast<double>(stale.rows) < kSmallestShare * static_cast<double>(x.size())) {
        continue;
      }
      found.push_back({joint, position, stale});
    }
  }
  if (found.empty()) return;
  DataFault fault;
  fault.kind = DataFaultKind::kStaleSamples;
  fault.joint = found.front().joint;
  std::string what;
  Index longest = 0;
  for (const Found& at : found) {
    if (at.joint != fault.joint) fault.joint = -1;
    const double share =
        static_cast<double>(at.stale.rows) / static_cast<double>(log.sample_count());
    fault.size = std::max(fault.size, share);
    longest = std::max(longest, at.stale.longest);
    what += fmt::format("{}{} of joint {}: {:.1f} % of the rows in {} bursts",
                        what.empty() ? "" : "; ", at.position ? "position" : "torque", at.joint + 1,
                        100 * share, at.stale.bursts);
  }
  fault.words = fmt::format(
      "values repeat exactly while the robot moves, then jump: {}; the longest burst has {} rows "
      "({:.3g} s)",
      what, longest, static_cast<double>(longest) * log.period_s);
  fault.mend =
      "log every sample anew (look for lost packets or a blocked reader), or leave the repeated "
      "rows out";
  faults.push_back(std::move(fault));
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
    fault.words = fmt::format(
        "the position of {} never changes, while its velocity adds up to {:.3g} {} of travel",
        joint_words(joint), moved,
        unit_of(Quantity::kPosition, robot.joints[static_cast<std::size_t>(joint)].joint.type));
    fault.mend = "look at its encoder and at the channel that it is logged from";
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::desk
