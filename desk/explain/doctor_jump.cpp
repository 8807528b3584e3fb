#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
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
  // Of every change from one row to the next, what is more than the pace around it brings, and
  // that; empty where nothing had to be looked at.
  VectorXd excess;
  VectorXd expected;
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

// How a joint goes on behind a row: by how much at once, and by how much a row around it.
struct GoesOn {
  double at_once = 0;
  double a_row = 0;
};
GoesOn goes_on(const Eigen::Ref<const VectorXd>& q, Index row) {
  constexpr Index kAround = 16;
  const Index before = std::min(kAround, row);
  const Index after = std::min(kAround, q.size() - 2 - row);
  if (before == 0 || after == 0) return {};
  const double slope = (q[row] - q[row - before]) / static_cast<double>(before) +
                       (q[row + 1 + after] - q[row + 1]) / static_cast<double>(after);
  return {q[row + 1] - q[row], slope / 2};
}

// Whether behind a row all joints have gone on as if the same time had passed: rows are missing
// there, whatever the time stamps say, and no joint counts from another zero. `joint`: one that
// shows it. Of the others those count that would have to show it.
bool is_loss(const Log& log, const std::vector<double>& usual, Index row, Index joint) {
  constexpr double kShows = 6;  // times a usual change from one row to the next
  // Times what it would have to be, or that part of it: paces change meanwhile.
  constexpr double kAlike = 3;
  const GoesOn own = goes_on(log.q.col(joint), row);
  const double rows = own.at_once / own.a_row;
  if (!(rows > 2) || !std::isfinite(rows)) return false;
  int alike = 0;
  int others = 0;
  for (Index i = 0; i < log.q.cols(); ++i) {
    const GoesOn other = goes_on(log.q.col(i), row);
    const double wanted = rows * other.a_row;
    if (i == joint || !(std::abs(wanted) > kShows * usual[static_cast<std::size_t>(i)])) continue;
    ++others;
    const double share = other.at_once / wanted;
    if (share > 1 / kAlike && share < kAlike) ++alike;
  }
  return others > 0 && 2 * alike > others;
}

// Such rows, in order.
std::vector<Index> rows_before_a_loss(const Log& log, const std::vector<Breaks>& of_joints) {
  const bool any = std::any_of(of_joints.begin(), of_joints.end(),
                               [](const Breaks& one) { return !one.steps.empty(); });
  if (!any) return {};
  const Index steps = log.q.rows() - 1;
  std::vector<double> usual;
  for (Index i = 0; i < log.q.cols(); ++i) {
    const auto q = log.q.col(i);
    usual.push_back((q.tail(steps) - q.head(steps)).cwiseAbs().mean());
  }
  std::set<Index> lost;
  for (std::size_t i = 0; i < of_joints.size(); ++i) {
    for (const Index row : of_joints[i].steps) {
      if (is_loss(log, usual, row, static_cast<Index>(i))) lost.insert(row);
    }
  }
  return {lost.begin(), lost.end()};
}

// Of a channel that is known to repeat: it catches up after every burst.
std::vector<RowSpan> known_of_position(const Log& log, Index joint,
                                       const std::vector<DataFault>& faults) {
  std::vector<RowSpan> known = known_spans(faults, joint, FaultySignal::kPosition);
  const bool stale = std::any_of(faults.begin(), faults.end(), [&](const DataFault& fault) {
    return fault.kind == DataFaultKind::kStaleSamples && fault.joint == joint &&
           fault.signal == FaultySignal::kPosition;
  });
  if (!stale) return known;
  for (const Burst& burst : repeats_of(log.q.col(joint))) {
    known.push_back({burst.first, burst.end() + 1});
  }
  return known;
}

void find_position_jumps(const Log& log, Index joint, const std::vector<Index>& lost, Breaks jumps,
                         std::vector<DataFault>& faults) {
  const Index rows = log.q.rows();
  std::vector<RowSpan> beside_loss;
  std::erase_if(jumps.steps, [&](const Index row) {
    const bool is_lost = std::find(lost.begin(), lost.end(), row) != lost.end();
    if (is_lost) beside_loss.push_back({row, row + 1});
    return is_lost;
  });
  add_jump_fault(log, joint, true, DataFaultKind::kJump, beside_loss, jumps.largest,
                 "jumps as the other joints do, as if rows were missing there", faults);
  add_jump_fault(log, joint, true, DataFaultKind::kJump, jumps.spikes, jumps.largest,
                 "jumps and comes back", faults);
  std::vector<RowSpan> sides;
  if (jumps.steps.size() == 1) {
    sides.push_back(shorter_side(jumps.steps[0], rows));
  } else if (jumps.steps.size() > 1) {
    // Between jumps there and back the zero is another; of more than two none is known.
    for (std::size_t i = 0; i + 1 < jumps.steps.size(); i += 2) {
      sides.push_back({jumps.steps[i] + 1, jumps.steps[i + 1]});
    }
    if (jumps.steps.size() % 2 == 1) sides.push_back(shorter_side(jumps.steps.back(), rows));
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

// Rows at the start of a signal that have not settled; 0 where it is at fault already.
Index unsettled_of(const Log& log, Index joint, bool position,
                   const std::vector<DataFault>& faults) {
  const auto signal = position ? FaultySignal::kPosition : FaultySignal::kTorque;
  const bool known = std::any_of(faults.begin(), faults.end(), [&](const DataFault& fault) {
    return fault.joint == joint && fault.signal == signal;
  });
  if (known) return 0;
  return unsettled_rows(position ? log.q.col(joint) : log.tau.col(joint), position);
}

void add_unsettled(const Log& log, Index joint, bool position, Index unsettled,
                   std::vector<DataFault>& faults) {
  if (unsettled == 0) return;
  add_jump_fault(log, joint, position, DataFaultKind::kStart, {{0, unsettled - 1}},
                 static_cast<double>(unsettled) / static_cast<double>(log.sample_count()),
                 "changes at the start as it never does later", faults);
}

void find_torque_spikes(const Log& log, Index joint, std::vector<DataFault>& faults) {
  const VectorXd tau = log.tau.col(joint);
  const auto spikes = torque_spikes(tau, known_spans(faults, joint, FaultySignal::kTorque));
  double largest = 0;
  for (const RowSpan& span : spikes) {
    largest = std::max(largest, tau.segment(span.first, span.count()).cwiseAbs().maxCoeff());
  }
  add_jump_fault(log, joint, false, DataFaultKind::kJump, spikes, largest, "has spikes", faults);
}

}  // namespace

std::string mend_of_start() {
  return "start to record when the drive is on and its filters have settled";
}

void find_jumps(const Log& log, std::vector<DataFault>& faults) {
  const auto joints = static_cast<std::size_t>(log.q.cols());
  std::vector<Index> unsettled(joints, 0);  // of the positions
  std::vector<Breaks> breaks = of_every_joint(log, [&](Index joint) {
    if (stands_still(log.q.col(joint))) return Breaks{};
    const Index own = unsettled_of(log, joint, true, faults);
    unsettled[static_cast<std::size_t>(joint)] = own;
    std::vector<RowSpan> known = known_of_position(log, joint, faults);
    if (own > 0) known.push_back({-1, own});
    return breaks_of(log, log.q.col(joint), known);
  });
  const std::vector<Index> lost = rows_before_a_loss(log, breaks);
  for (std::size_t i = 0; i < joints; ++i) {
    const auto joint = static_cast<Index>(i);
    add_unsettled(log, joint, true, unsettled[i], faults);
    find_position_jumps(log, joint, lost, std::move(breaks[i]), faults);
    add_unsettled(log, joint, false, unsettled_of(log, joint, false, faults), faults);
    find_torque_spikes(log, joint, faults);
  }
}

}  // namespace offnominal::desk
