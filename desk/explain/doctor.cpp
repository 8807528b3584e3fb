#include "explain/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/parallel.hpp"
#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"
#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "explain/treatment.hpp"
#include "log/part_of.hpp"
#include "log/sampling.hpp"
#include "robot/payload.hpp"
#include "signal/decimate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

const char* name_of(DataFaultKind kind) {
  switch (kind) {
    case DataFaultKind::kDegrees:
      return "degrees";
    case DataFaultKind::kTorqueSign:
      return "torque_sign";
    case DataFaultKind::kStaleSamples:
      return "stale_samples";
    case DataFaultKind::kClockSkew:
      return "clock_skew";
    case DataFaultKind::kSaturation:
      return "saturation";
    case DataFaultKind::kGaps:
      return "gaps";
    case DataFaultKind::kTimeUnit:
      return "time_unit";
    case DataFaultKind::kVelocity:
      return "velocity";
    case DataFaultKind::kWrapped:
      return "wrapped_position";
    case DataFaultKind::kStuck:
      return "stuck";
    case DataFaultKind::kJump:
      return "jump";
    case DataFaultKind::kStart:
      return "start";
    case DataFaultKind::kNothingLeft:
      return "nothing_left";
    case DataFaultKind::kGravity:
      return "gravity";
    case DataFaultKind::kTorqueUnit:
      return "torque_unit";
    case DataFaultKind::kJointOrder:
      return "joint_order";
    case DataFaultKind::kJointZero:
      return "joint_zero";
  }
  return "";
}

bool spoils(const DataFault& fault, RestsOn what) {
  if (!fault.certain || fault.overruled || !fault.left_out_of.empty()) return false;
  switch (fault.kind) {
    case DataFaultKind::kNothingLeft:
    case DataFaultKind::kGravity:
    case DataFaultKind::kDegrees:
    case DataFaultKind::kTorqueSign:
    case DataFaultKind::kTorqueUnit:
    case DataFaultKind::kJointOrder:
    case DataFaultKind::kJointZero:
    case DataFaultKind::kTimeUnit:
    case DataFaultKind::kWrapped:
      return true;
    case DataFaultKind::kVelocity:
      return what == RestsOn::kVelocityToo;
    default:
      return false;
  }
}

std::string joint_words(Index joint) {
  return joint < 0 ? "all joints" : fmt::format("joint {}", joint + 1);
}

std::optional<SlowSignals> slow_signals(const Log& log, double cutoff_of_rate) {
  // Robots move below this; above it the second derivative of a coarse encoder outweighs the
  // torque.
  constexpr double kCutoffHz = 5;
  constexpr double kCutoffOfRate = 0.1;     // for slow logs
  constexpr double kSamplesPerCutoff = 16;  // kept of every period of the cut-off
  constexpr double kShortestPeriods =
      8;  // of the cut-off; the filter's ends spoil one on each side
  const double rate_hz = log.sample_rate_hz();
  SlowSignals slow;
  slow.cutoff_hz =
      cutoff_of_rate > 0 ? cutoff_of_rate * rate_hz : std::min(kCutoffHz, kCutoffOfRate * rate_hz);
  const auto rows_per_period = static_cast<Index>(std::ceil(rate_hz / slow.cutoff_hz));
  if (static_cast<double>(log.sample_count()) <
      kShortestPeriods * static_cast<double>(rows_per_period)) {
    return std::nullopt;
  }
  FilterPlan plan;
  plan.sample_rate_hz = rate_hz;
  plan.position_cutoff_hz = 2 * slow.cutoff_hz;
  const auto stride =
      std::max<Index>(1, static_cast<Index>(rate_hz / (kSamplesPerCutoff * slow.cutoff_hz)));
  slow.period_s = log.period_s * static_cast<double>(stride);
  slow.edge = rows_per_period / stride + 1;
  slow.motion = thin_motion_of(log, plan, stride);
  slow.torque.resize(slow.motion.sample_count(), log.tau.cols());
  for_every_column(log.tau, [&](Index joint) {
    slow.torque.col(joint) = every_nth(
        zero_phase_low_pass(log.tau.col(joint), plan.position_cutoff_hz, rate_hz), stride);
  });
  slow.payload = log.payload;
  return slow;
}

std::optional<TorquePair> torque_pair(const SlowSignals& slow, const RobotDescription& robot,
                                      WithLinks links) {
  TorquePair pair;
  pair.period_s = slow.period_s;
  pair.cutoff_hz = slow.cutoff_hz;
  const auto smooth = [&](const MatrixXd& thin) {
    MatrixXd result(thin.rows() - 2 * slow.edge, thin.cols());
    for (Index joint = 0; joint < thin.cols(); ++joint) {
      result.col(joint) = zero_phase_low_pass(thin.col(joint), pair.cutoff_hz, 1 / pair.period_s)
                              .segment(slow.edge, result.rows());
    }
    return result;
  };
  RobotDescription rigid = robot;
  rigid.effects.clear();
  rigid = carrying(rigid, slow.payload);
  pair.measured = smooth(slow.torque);
  pair.model = smooth(model_torque(carrying(robot, slow.payload), slow.motion));
  pair.load = smooth(model_torque(rigid, slow.motion));
  for (std::size_t link = 0; links == WithLinks::kYes && link < robot.joints.size(); ++link) {
    pair.links.push_back(smooth(link_torque(robot, link, slow.motion)));
  }
  pair.t_s = slow.motion.t_s.segment(slow.edge, pair.measured.rows());
  pair.q = smooth(slow.motion.q);
  pair.dq = smooth(slow.motion.dq);
  pair.ddq = smooth(slow.motion.ddq);
  if (!pair.measured.allFinite() || !pair.model.allFinite()) return std::nullopt;
  return pair;
}

std::optional<TorquePair> torque_pair(const Log& log, const RobotDescription& robot) {
  const auto slow = slow_signals(log);
  return slow ? torque_pair(*slow, robot, WithLinks::kYes) : std::nullopt;
}

TorquePair thinned(const TorquePair& pair) {
  constexpr Index kMostRows = 200;
  const Index stride = std::max<Index>(1, (pair.q.rows() + kMostRows - 1) / kMostRows);
  TorquePair rows;
  rows.t_s = every_nth(pair.t_s, stride);
  rows.q = every_nth_row(pair.q, stride);
  rows.dq = every_nth_row(pair.dq, stride);
  rows.ddq = every_nth_row(pair.ddq, stride);
  rows.measured = every_nth_row(pair.measured, stride);
  rows.model = every_nth_row(pair.model, stride);
  return rows;
}

void find_gaps(const Log& log, std::vector<DataFault>& faults) {
  // One lost row makes a step of two periods; clocks of an ordinary computer stay below this.
  constexpr double kLongestStep = 1.5;
  const Sampling sampling = sampling_of(log.t_s);
  DataFault fault;
  fault.kind = DataFaultKind::kGaps;
  fault.unit = "s";
  fault.mend = "record without losing samples";
  std::vector<RowSpan> spans = log.gaps;
  for (const RowSpan& gap : spans) {
    fault.size = std::max(fault.size, static_cast<double>(gap.count() + 1) * log.period_s);
  }
  for (Index i = 0; i + 1 < log.t_s.size(); ++i) {
    const double step = log.t_s[i + 1] - log.t_s[i];
    if (!(step > kLongestStep * sampling.median_period_s)) continue;
    spans.push_back({i, i + 1});
    fault.size = std::max(fault.size, step);
  }
  if (!spans.empty()) {
    set_spans(log, spans, fault);
    fault.words =
        fmt::format("rows are missing: {:.4g} s between samples mostly, but up to {:.4g} s: {}",
                    sampling.median_period_s, fault.size, words_of_spans(fault));
    faults.push_back(fault);
  }
  if (log.cut.empty()) return;
  fault.spans.clear();
  Index rows = 0;
  for (const RowSpan& part : log.cut) {
    fault.spans.push_back({{0, -1},
                           log.row_number(part.first) + 1,
                           log.row_number(part.last) + 1,
                           log.stamps_s[part.first],
                           log.stamps_s[part.last]});
    rows += part.count();
  }
  fault.at_s = fault.spans.front().from_s;
  fault.size = static_cast<double>(rows) / static_cast<double>(log.stamps_s.size());
  fault.unit = "";
  fault.words = fmt::format(
      "rows are missing for more than {:g} s; {:.1f} % of the rows lie beyond and are left out: {}",
      kLongestGapS, 100 * fault.size, words_of(fault.spans.front()));
  fault.mend = "give the parts as recordings of their own";
  faults.push_back(std::move(fault));
}

namespace {

// A torque that is at fault from the first row to the last says nothing; all the rest may be right.
bool is_unrecorded(const DataFault& fault, const Log& log) {
  return fault.kind == DataFaultKind::kStuck && fault.signal == FaultySignal::kTorque &&
         fault.spans.size() == 1 && fault.spans.front().samples.count() == log.sample_count();
}

// An encoder that sticks, jumps or starts late cannot be told from a joint that is held, and a
// torque that stays is right there.
void leave_out_of_held(const Log& log, const RobotDescription& robot,
                       std::vector<DataFault>& faults) {
  const std::vector<char> held = held_joints(log, robot);
  std::erase_if(faults, [&](const DataFault& fault) {
    const bool by_motion =
        fault.kind == DataFaultKind::kStuck ||
        (fault.signal == FaultySignal::kPosition &&
         (fault.kind == DataFaultKind::kJump || fault.kind == DataFaultKind::kStart));
    return by_motion && fault.joint >= 0 && held[static_cast<std::size_t>(fault.joint)] != 0 &&
           !is_unrecorded(fault, log);
  });
}

// The longest part of a recording that no fault touches for longer than a filter forgives; none
// where that is nothing, the recording itself where it is all of it.
Log longest_good_part(Log log, const std::vector<DataFault>& faults) {
  constexpr double kForgivenS = 0.1;
  std::vector<char> bad(static_cast<std::size_t>(log.sample_count()), 0);
  for (const DataFault& fault : faults) {
    if (fault.kind == DataFaultKind::kSaturation || is_unrecorded(fault, log)) continue;
    for (const FaultSpan& span : fault.spans) {
      if (static_cast<double>(span.samples.count()) * log.period_s < kForgivenS) continue;
      for (Index i = span.samples.first; i <= span.samples.last; ++i)
        bad[static_cast<std::size_t>(i)] = 1;
    }
  }
  RowSpan best{0, -1};
  for (Index i = 0; i < log.sample_count(); ++i) {
    if (bad[static_cast<std::size_t>(i)] != 0) continue;
    const Index first = i;
    while (i + 1 < log.sample_count() && bad[static_cast<std::size_t>(i + 1)] == 0) ++i;
    if (i + 1 - first > best.count()) best = {first, i};
  }
  if (best.count() == log.sample_count()) return log;
  return part_of(log, best);
}

// Over a gap the last value stays: a straight line has steps that no sensor has.
Log held_over_gaps(const Log& log) {
  Log held = log;
  for (const RowSpan& gap : log.gaps) {
    const Index before = std::max<Index>(gap.first - 1, 0);
    for (Index i = gap.first; i <= gap.last; ++i) {
      held.q.row(i) = log.q.row(before);
      held.tau.row(i) = log.tau.row(before);
    }
  }
  return held;
}

// Every check of a stretch, in the order in which they need each other. `held`: with values held
// over gaps, where `log` has any; `even`: the same, evenly sampled.
void find_faults_of_stretches(const Log& held, const Log& log, const Log& even,
                              const RobotDescription& robot, std::vector<DataFault>& faults) {
  const ExpectedTorque expected(even, robot);
  find_unrecorded_torques(held, even, robot, faults);
  find_stale_samples(held, faults);
  find_stuck_values(held, expected, faults);
  find_stuck_encoders(log, robot, faults);
  find_torque_excursions(held, even, robot, faults);
  find_jumps(log, faults);
  find_unsettled_torques(held, expected, faults);
  find_saturation(held, robot, expected, faults);
}

// The same of rows that were resampled: a spline and straight lines have no steps of an encoder,
// and neither repeat a value nor jump.
std::vector<DataFault> faults_of_rows(const Log& log, const RobotDescription& robot) {
  const Log rows = rows_as_recorded(log);
  std::vector<DataFault> local;
  if (!rows.gaps.empty()) {
    DataFault gaps;
    set_spans(rows, rows.gaps, gaps);
    local.push_back(std::move(gaps));
  }
  find_faults_of_stretches(rows, rows, log, robot, local);
  if (!rows.gaps.empty()) local.erase(local.begin());
  to_samples(log, local);
  std::vector<DataFault> faults;
  find_gaps(log, faults);
  faults.insert(faults.end(), local.begin(), local.end());
  return faults;
}

// What is at fault for some stretches.
std::vector<DataFault> local_faults(const Log& log, const RobotDescription& robot) {
  std::vector<DataFault> faults;
  if (log.recorded) return faults_of_rows(log, robot);
  const Log held = log.gaps.empty() ? Log{} : held_over_gaps(log);
  const Log& as_recorded = log.gaps.empty() ? log : held;
  find_gaps(log, faults);
  find_faults_of_stretches(as_recorded, log, as_recorded, robot, faults);
  return faults;
}

// Of torques in their unit: the first that they all follow from, else what single joints have.
void find_in_torques(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                     std::vector<DataFault>& faults) {
  const std::size_t before = faults.size();
  const bool may_be_gravity = find_gravity(log, robot, pair, faults);
  if (may_be_gravity && faults.back().certain) return;
  if (!(find_joint_zero(log, robot, pair, faults) && faults.back().certain)) {
    find_joint_gravity(log, robot, pair, faults);
    find_torque_sign(log, robot, pair, faults);
  }
  // Where something else is what is off, another gravity only looked like it.
  if (may_be_gravity && faults.size() > before + 1) {
    faults.erase(faults.begin() + static_cast<std::ptrdiff_t>(before));
  }
}

}  // namespace

std::vector<DataFault> examine(const Log& log, const RobotDescription& robot) {
  if (log.q.cols() != robot.joint_count() || log.tau.cols() != robot.joint_count()) {
    throw std::invalid_argument("the recording has another number of joints than the robot");
  }
  std::vector<DataFault> faults;
  constexpr Index kFewestSamples = 10;  // as read_log.hpp's kMinSamples
  if (log.sample_count() < kFewestSamples) return faults;
  Log mended = log;
  mend_wrapped(mended, robot, faults);
  mend_time(mended, robot, faults);
  const std::size_t before = faults.size();
  std::vector<DataFault> local = local_faults(mended, robot);
  leave_out_of_held(mended, robot, local);
  for (const DataFault& fault : local) {
    bridge(fault, mended);
    if (is_unrecorded(fault, mended)) mended.tau.col(fault.joint).setZero();
  }
  mended = longest_good_part(std::move(mended), local);
  if (mended.sample_count() >= kFewestSamples) {
    mend_degrees(mended, robot, faults);
    if (faults.size() > before) {
      // What was held against the model's torque is to be looked at anew.
      Log radians = log;
      std::vector<DataFault> again;
      mend_wrapped(radians, robot, again);
      mend_time(radians, robot, again);
      again.clear();
      mend_degrees(radians, robot, again);
      if (!again.empty()) {
        local = local_faults(radians, robot);
        leave_out_of_held(radians, robot, local);
      }
    }
    mend_strange_velocities(mended, robot, faults);
    mend_velocities(mended, robot, faults);
    if (const auto pair = torque_pair(mended, robot)) {
      // The first that all torques follow from: nothing else is then held against them.
      if (!find_joint_order(mended, robot, *pair, faults)) {
        const OfAnotherUnit unit = find_torque_unit(mended, robot, *pair, faults);
        if (unit == OfAnotherUnit::kSomeJoints) find_torque_sign(mended, robot, *pair, faults);
        if (unit == OfAnotherUnit::kNone) find_in_torques(mended, robot, *pair, faults);
        find_clock_skew(mended, *pair, faults);
      }
    }
  }
  faults.insert(faults.begin() + static_cast<std::ptrdiff_t>(before), local.begin(), local.end());
  for (DataFault& fault : faults) fault.file = log.file;
  return faults;
}

}  // namespace offnominal::desk
