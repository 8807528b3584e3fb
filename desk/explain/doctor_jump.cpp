#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/time_words.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "signal/quantile.hpp"

// What no joint does from one sample to the next: spikes, positions that are counted from another
// zero from some row on, and a start that has not settled.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kAroundRows = 8;
constexpr double kUsualShare = 0.99;
constexpr double kNoiseDeviations = 12;  // standard deviations
constexpr double kDeviationOfMedian = 1.4826;
constexpr double kTimesTopPace = 3;
constexpr double kTimesStep = 4;
// A joint that is held gives way by a few steps at once, and stays there.
constexpr double kStepsOfAnotherZero = 20;

double median_of(VectorXd values) { return quantile(std::move(values), 0.5); }

// By how much each change from one row to the next exceeds those around it, for the time that
// passes meanwhile, in rows.
VectorXd excess_of(const VectorXd& change, const VectorXd& per_row, const VectorXd& passed) {
  VectorXd excess = VectorXd::Zero(change.size());
  for (Index i = 0; i < change.size(); ++i) {
    const Index before = std::min(i, kAroundRows);
    const Index after = std::min(change.size() - 1 - i, kAroundRows);
    double pace = 0;
    int sides = 0;
    if (before > 0) {
      pace += median_of(per_row.segment(i - before, before));
      ++sides;
    }
    if (after > 0) {
      pace += median_of(per_row.segment(i + 1, after));
      ++sides;
    }
    if (sides > 0) excess[i] = change[i] - pace / sides * passed[i];
  }
  return excess;
}

struct Breaks {
  std::vector<RowSpan> spikes;  // rows that are off
  std::vector<Index> steps;     // rows behind which another zero counts
  double largest = 0;
};

bool holds(const std::vector<RowSpan>& spans, Index row) {
  return std::any_of(spans.begin(), spans.end(), [row](const RowSpan& span) {
    return row >= span.first - 1 && row <= span.last;
  });
}

Breaks breaks_of(const Log& log, const VectorXd& q, const std::vector<RowSpan>& known) {
  constexpr double kShortestStep = 0.1;
  Breaks jumps;
  const Index steps = q.size() - 1;
  if (steps < 4 * kAroundRows) return jumps;
  const VectorXd change = q.tail(steps) - q.head(steps);
  const VectorXd passed = rows_passed(log);
  const VectorXd time = (log.t_s.tail(steps) - log.t_s.head(steps)) / log.period_s;
  const VectorXd per_row = change.cwiseQuotient(time.cwiseMax(kShortestStep));
  const double pace = quantile(change.cwiseQuotient(passed).cwiseAbs(), kUsualShare);
  const double step = Rounding(q).at(q.cwiseAbs().maxCoeff());
  if (!std::isfinite(step)) return jumps;
  // Changes that cannot be jumps need no look at their surroundings.
  const double least = kTimesTopPace * pace + kTimesStep * step;
  if (!(change.cwiseAbs().maxCoeff() > least)) return jumps;
  const VectorXd excess = excess_of(change, per_row, passed);
  const double limit =
      std::max(least, kNoiseDeviations * kDeviationOfMedian * median_of(excess.cwiseAbs()));
  for (Index i = 0; i < steps; ++i) {
    if (!(std::abs(excess[i]) > limit * passed[i]) || holds(known, i)) continue;
    jumps.largest = std::max(jumps.largest, std::abs(excess[i]));
    Index back = -1;
    double off = excess[i];
    for (Index j = i + 1; j <= std::min(i + kLongestSpike, steps - 1); ++j) {
      off += excess[j];
      if (std::abs(off) <= std::max(limit, 0.2 * std::abs(excess[i]))) {
        back = j;
        break;
      }
    }
    if (back >= 0) {
      jumps.spikes.push_back({i + 1, back});
      i = back;
    } else if (i < kLongestSpike) {
      jumps.spikes.push_back({0, i});
    } else if (steps - 1 - i < kLongestSpike) {
      jumps.spikes.push_back({i + 1, steps});
    } else if (std::abs(excess[i]) > kStepsOfAnotherZero * step) {
      jumps.steps.push_back(i);
    }
  }
  return jumps;
}

// Rows of a torque that are far off both what comes before and what comes after.
std::vector<RowSpan> torque_spikes(const VectorXd& tau, const std::vector<RowSpan>& known) {
  constexpr Index kHalfWindow = 4;
  constexpr Index kLongestTorqueSpike = 3;
  constexpr double kOfLargest = 1.2;
  constexpr double kUnlikeAny = 6;
  constexpr double kBesidePeak = 0.4;
  std::vector<RowSpan> spikes;
  const Index rows = tau.size();
  if (rows < 8 * kHalfWindow) return spikes;
  const double large = kOfLargest * quantile(tau.cwiseAbs(), kUsualShare);
  const VectorXd change = (tau.tail(rows - 1) - tau.head(rows - 1)).cwiseAbs();
  if (!(change.maxCoeff() > large)) return spikes;
  VectorXd off(rows);
  for (Index i = 0; i < rows; ++i) {
    const Index first = std::clamp<Index>(i - kHalfWindow, 0, rows - 1 - 2 * kHalfWindow);
    off[i] = std::abs(tau[i] - median_of(tau.segment(first, 2 * kHalfWindow + 1)));
  }
  const double limit = std::max({large, kNoiseDeviations * kDeviationOfMedian * median_of(off),
                                 kUnlikeAny * quantile(off, kUsualShare)});
  for (Index i = 0; i < rows; ++i) {
    if (!(off[i] > limit)) continue;
    Index last = i;
    while (last + 1 < rows && off[last + 1] > limit) ++last;
    const RowSpan span{i, last};
    i = last;
    if (span.count() > kLongestTorqueSpike || holds(known, span.first)) continue;
    // A blow in the gear rises and falls over some rows.
    const double peak = off.segment(span.first, span.count()).maxCoeff();
    const double beside = std::max(span.first > 0 ? off[span.first - 1] : 0,
                                   span.last + 1 < rows ? off[span.last + 1] : 0);
    if (beside < kBesidePeak * peak) spikes.push_back(span);
  }
  return spikes;
}

// Rows at the start in which the signal changes as it never does later; 0: none.
Index unsettled_rows(const VectorXd& x, bool position) {
  constexpr double kUnlikeLater = 3;
  constexpr Index kWidest = 16;
  constexpr Index kPart = 5;  // of the recording, that may be start
  Index unsettled = 0;
  const Index rows = x.size();
  const double step = smallest_step(x);
  for (Index width = position ? 1 : 4; width <= kWidest; width *= 2) {
    const Index count = rows - width;
    if (count < 20 * kWidest || !std::isfinite(step)) return 0;
    const VectorXd change = (x.tail(count) - x.head(count)).cwiseAbs();
    const double later = change.tail(count - count / kPart).maxCoeff();
    // It changes most at once, then less and less.
    if (!(change.head(2).maxCoeff() > kUnlikeLater * later + kTimesStep * step)) continue;
    Index i = 0;
    while (i < count / kPart && change[i] > later) ++i;
    // Half way down an exponential from three times or more.
    constexpr double kHalfWay = 0.65;
    constexpr Index kFewestToTell = 8;
    if (i >= kFewestToTell && change[i / 2] > kHalfWay * change.head(2).maxCoeff()) continue;
    unsettled = std::max(unsettled, i + 2 * width);
  }
  return std::min(unsettled + unsettled / 2, rows / kPart);
}

void add_jump_fault(const Log& log, Index joint, bool position, DataFaultKind kind,
                    const std::vector<RowSpan>& spans, double size, const std::string& what,
                    std::vector<DataFault>& faults) {
  if (spans.empty()) return;
  DataFault fault;
  fault.kind = kind;
  fault.joint = joint;
  fault.signal = position ? FaultySignal::kPosition : FaultySignal::kTorque;
  fault.size = size;
  set_spans(log, spans, fault);
  fault.words = fmt::format("the {} of joint {} {}: {}", position ? "position" : "torque",
                            joint + 1, what, words_of_spans(fault));
  fault.mend = kind == DataFaultKind::kStart
                   ? mend_of_start()
                   : "look at the encoder, its cable and the bus; cut the recording there";
  faults.push_back(std::move(fault));
}

std::vector<RowSpan> known_spans(const std::vector<DataFault>& faults, Index joint,
                                 FaultySignal signal) {
  std::vector<RowSpan> spans;
  for (const DataFault& fault : faults) {
    const bool same = fault.joint < 0 || (fault.joint == joint && fault.signal == signal);
    if (!same) continue;
    for (const FaultSpan& span : fault.spans) {
      spans.push_back({span.samples.first - 1, span.samples.last + 1});
    }
  }
  return spans;
}

// Of a zero that moved only one side can be right; the longer one is kept.
RowSpan shorter_side(Index step, Index rows) {
  return step + 1 < rows - step - 1 ? RowSpan{0, step} : RowSpan{step + 1, rows - 1};
}

void find_position_jumps(const Log& log, Index joint, std::vector<DataFault>& faults) {
  const VectorXd q = log.q.col(joint);
  std::vector<RowSpan> known = known_spans(faults, joint, FaultySignal::kPosition);
  const bool stale = std::any_of(faults.begin(), faults.end(), [&](const DataFault& fault) {
    return fault.kind == DataFaultKind::kStaleSamples && fault.joint == joint &&
           fault.signal == FaultySignal::kPosition;
  });
  // A channel that is known to repeat catches up after every burst.
  if (stale) {
    for (const Burst& burst : repeats_of(q)) known.push_back({burst.first, burst.end() + 1});
  }
  const Breaks jumps = breaks_of(log, q, known);
  add_jump_fault(log, joint, true, DataFaultKind::kJump, jumps.spikes, jumps.largest,
                 "jumps and comes back", faults);
  std::vector<RowSpan> sides;
  if (jumps.steps.size() == 1) {
    sides.push_back(shorter_side(jumps.steps[0], q.size()));
  } else if (jumps.steps.size() > 1) {
    // Between jumps there and back the zero is another; of more than two none is known.
    for (std::size_t i = 0; i + 1 < jumps.steps.size(); i += 2) {
      sides.push_back({jumps.steps[i] + 1, jumps.steps[i + 1]});
    }
    if (jumps.steps.size() % 2 == 1) sides.push_back(shorter_side(jumps.steps.back(), q.size()));
  }
  const std::string what = jumps.steps.empty()
                               ? ""
                               : fmt::format(
                                     "jumps by {:.3g} at t = {} s and is counted from "
                                     "another zero; the shorter side is left out",
                                     jumps.largest, words_of_time(log.t_s[jumps.steps[0]]));
  const std::size_t before = faults.size();
  add_jump_fault(log, joint, true, DataFaultKind::kJump, sides, jumps.largest, what, faults);
  if (faults.size() > before) faults.back().at_s = log.t_s[jumps.steps[0]];
}

}  // namespace

std::string mend_of_start() {
  return "start to record when the drive is on and its filters have settled";
}

void find_jumps(const Log& log, std::vector<DataFault>& faults) {
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    for (const bool position : {true, false}) {
      const VectorXd x = position ? log.q.col(joint) : log.tau.col(joint);
      if (position && stands_still(x)) continue;
      const auto signal = position ? FaultySignal::kPosition : FaultySignal::kTorque;
      const bool known = std::any_of(faults.begin(), faults.end(), [&](const DataFault& fault) {
        return fault.joint == joint && fault.signal == signal;
      });
      const Index unsettled = known ? 0 : unsettled_rows(x, position);
      if (unsettled > 0) {
        add_jump_fault(log, joint, position, DataFaultKind::kStart, {{0, unsettled - 1}},
                       static_cast<double>(unsettled) / static_cast<double>(x.size()),
                       "changes at the start as it never does later", faults);
      }
      if (position) {
        find_position_jumps(log, joint, faults);
        continue;
      }
      const auto spikes = torque_spikes(x, known_spans(faults, joint, signal));
      double largest = 0;
      for (const RowSpan& span : spikes) {
        largest = std::max(largest, x.segment(span.first, span.count()).cwiseAbs().maxCoeff());
      }
      add_jump_fault(log, joint, false, DataFaultKind::kJump, spikes, largest, "has spikes",
                     faults);
    }
  }
}

}  // namespace offnominal::desk
