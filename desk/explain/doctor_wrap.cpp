#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "common/time_words.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "log/sampling.hpp"
#include "signal/fold.hpp"
#include "signal/quantile.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Of ranges that are not known. A jump is a step by most of the positions' range within this many
// samples: one where the samples are as recorded, a few where a spline put them on an even grid.
constexpr Index kJumpRows = 3;
// Samples on either side that tell how fast the joint moves there.
constexpr Index kPaceRows = 8;
// A position that is folded into a range never leaves it, and jumps by all of it.
constexpr double kOfRange = 0.9;
// What one sample shows of such a jump on an even grid, at least.
constexpr double kOfRangeInOneStep = 0.3;
// No joint moves like that: the jump is so many times what nearly all steps are.
constexpr double kOfSteps = 8;
constexpr double kNearlyAll = 0.95;
// The joint goes on as it came.
constexpr double kSamePace = 0.5;
constexpr double kSameSize = 0.02;

struct Jump {
  Index first = 0;  // row before it
  Index last = 0;   // row after it
  double size = 0;  // with the motion meanwhile taken off
};

double mean_step(const VectorXd& q, Index from, Index to) {
  return (q[to] - q[from]) / static_cast<double>(to - from);
}

// Whether the step behind row `i` is such a jump.
bool jump_at(const VectorXd& q, double range, Index i, Jump& jump) {
  jump.first = i - kJumpRows;
  jump.last = i + 1 + kJumpRows;
  if (jump.first < kPaceRows || jump.last + kPaceRows >= q.size()) return false;
  const double before = mean_step(q, jump.first - kPaceRows, jump.first);
  const double after = mean_step(q, jump.last, jump.last + kPaceRows);
  const double pace = (before + after) / 2;
  jump.size = q[jump.last] - q[jump.first] - pace * static_cast<double>(jump.last - jump.first);
  return std::abs(jump.size) > kOfRange * range && jump.size * pace < 0 &&
         std::abs(after - before) < kSamePace * (std::abs(before) + std::abs(after));
}

std::vector<Jump> jumps_of(const VectorXd& q) {
  std::vector<Jump> jumps;
  const Index steps = q.size() - 1;
  const double range = q.maxCoeff() - q.minCoeff();
  // Less is a count or two of an encoder that a joint at rest has moved by.
  constexpr double kLeastRange = 0.02;  // rad or m
  if (!(range > kLeastRange) || steps < 4 * kPaceRows) return jumps;
  const VectorXd change = (q.tail(steps) - q.head(steps)).cwiseAbs();
  const double least = std::max(kOfRangeInOneStep * range, kOfSteps * quantile(change, kNearlyAll));
  for (Index i = 0; i < steps; ++i) {
    Jump jump;
    if (change[i] < least || !jump_at(q, range, i, jump)) continue;
    jumps.push_back(jump);
    i = jump.last;
  }
  // A position that was set anew is no folded one.
  for (const Jump& jump : jumps) {
    if (std::abs(std::abs(jump.size) - std::abs(jumps[0].size)) > kSameSize * range) return {};
  }
  return jumps;
}

void unfold(VectorXd& q, const std::vector<Jump>& jumps) {
  double turns = 0;
  for (std::size_t k = 0; k < jumps.size(); ++k) {
    const Jump& jump = jumps[k];
    const double before = q[jump.first];
    turns -= jump.size;
    const Index end = k + 1 < jumps.size() ? jumps[k + 1].first : q.size() - 1;
    for (Index i = jump.last; i <= end; ++i) q[i] += turns;
    const double step = (q[jump.last] - before) / static_cast<double>(jump.last - jump.first);
    for (Index i = jump.first + 1; i < jump.last; ++i) {
      q[i] = before + step * static_cast<double>(i - jump.first);
    }
  }
}

struct Range {
  double size;
  std::string words;
};

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kTurnInDegrees = 360;
constexpr int kFewestBits = 8;

// The ranges that positions of a joint are folded into. Of its encoder's that which they fill.
std::vector<double> known_ranges(const VectorXd& q, const RobotJoint& joint) {
  std::vector<double> ranges;
  if (joint.joint.type == JointType::kRevolute) ranges = {kTurn, kTurnInDegrees};
  const double counts = (q.maxCoeff() - q.minCoeff()) * joint.encoder.counts_per_unit;
  // The last count of a range is one less.
  const double bits = counts > 0 ? std::ceil(std::log2(0.99 * counts)) : 0;
  if (bits >= kFewestBits) ranges.push_back(std::exp2(bits) / joint.encoder.counts_per_unit);
  return ranges;
}

// What a position that jumps by about `size` is folded into.
Range range_of(double size, const std::string& unit, double counts_per_unit) {
  constexpr double kSameRange = 0.02;
  const auto is = [size](double known) { return std::abs(size / known - 1) < kSameRange; };
  if (is(kTurn)) return {kTurn, "one turn, 2 pi"};
  if (is(kTurnInDegrees)) return {kTurnInDegrees, "one turn in degrees, 360"};
  if (counts_per_unit > 0) {
    const double bits = std::round(std::log2(size * counts_per_unit));
    const double known = std::exp2(bits) / counts_per_unit;
    if (bits >= kFewestBits && is(known)) {
      return {known, fmt::format("its encoder's 2^{:.0f} counts, {:.4g} {}", bits, known, unit)};
    }
  }
  return {size, fmt::format("{:.3g} {}", size, unit)};
}

struct Folded {
  double size;  // of the range, as the jumps have it
  Index first;  // row before the first jump
  std::size_t count;
};

// Unfolds positions where they are folded. A known range tells by single steps, whatever the joint
// does there; any other only by a joint that moves on, at its old pace, after a jump.
std::optional<Folded> unfolded(VectorXd& q, const RobotJoint& joint) {
  for (const double range : known_ranges(q, joint)) {
    const std::vector<Index> folds = folds_of(q, range);
    if (folds.empty()) continue;
    desk::unfold(q, range, folds);
    return Folded{range, folds.front(), folds.size()};
  }
  const std::vector<Jump> jumps = jumps_of(q);
  if (jumps.empty()) return std::nullopt;
  unfold(q, jumps);
  return Folded{std::abs(jumps[0].size), jumps[0].first + kJumpRows, jumps.size()};
}

}  // namespace

void mend_wrapped(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults) {
  bool derived = false;  // a velocity, from folded positions
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const RobotJoint& of = robot.joints[static_cast<std::size_t>(joint)];
    VectorXd q = log.q.col(joint);
    // A resampling makes a swing of every step of an encoder.
    const VectorXd recorded = log.recorded ? VectorXd(log.recorded->q.col(joint)) : q;
    if (stands_still(recorded)) continue;
    const auto found = unfolded(q, of);
    if (!found) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kWrapped;
    fault.joint = joint;
    fault.unit = unit_of(Quantity::kPosition, of.joint.type);
    const Range range = range_of(found->size, fault.unit, of.encoder.counts_per_unit);
    fault.size = range.size;
    fault.at_s = log.t_s[found->first];
    fault.words = fmt::format(
        "the position of {} is folded into {}: it jumps {} time{}, first at t = {} s, and goes "
        "on as it came",
        joint_words(joint), range.words, found->count, found->count == 1 ? "" : "s",
        words_of_time(*fault.at_s));
    const std::string by_hand = fmt::format(
        "log positions that count turns, or unfold the column before: add {:.6g} after each jump "
        "down and take it off after each jump up",
        fault.size);
    fault.mend = fault.size == kTurnInDegrees
                     ? "say unit = \"deg\" in its channel, a turn is then unfolded as it is read; "
                       "where it is not in degrees, " +
                           by_hand
                     : by_hand;
    faults.push_back(std::move(fault));
    log.q.col(joint) = q;
    change_recorded(log, [&](RecordedRows& rows) {
      VectorXd of_rows = rows.q.col(joint);
      unfolded(of_rows, of);
      rows.q.col(joint) = of_rows;
    });
    derived = derived || log.dq_derived[static_cast<std::size_t>(joint)];
  }
  if (derived) derive_velocities(log);
}

}  // namespace offnominal::desk
