#include "explain/treatment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/list_of_joints.hpp"
#include "common/nearest.hpp"
#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"
#include "compare/usable.hpp"
#include "explain/doctor.hpp"
#include "explain/doctor_signal.hpp"
#include "log/sampling.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The cut-off that plans have (filter_plan.hpp), where none is known yet.
constexpr double kNominalCutoffHz = 10;
constexpr double kNominalOfRate = 0.2;

FilterPlan usual_plan(const Log& log) {
  FilterPlan plan;
  plan.sample_rate_hz = log.sample_rate_hz();
  plan.torque_cutoff_hz = std::min(kNominalCutoffHz, kNominalOfRate * plan.sample_rate_hz);
  plan.position_cutoff_hz = 2 * plan.torque_cutoff_hz;
  return plan;
}

bool is_treated(DataFaultKind kind) {
  switch (kind) {
    case DataFaultKind::kStaleSamples:
    case DataFaultKind::kSaturation:
    case DataFaultKind::kGaps:
    case DataFaultKind::kStuck:
    case DataFaultKind::kJump:
    case DataFaultKind::kStart:
      return true;
    default:
      return false;
  }
}

bool is_kept(const DataFault& fault, const std::vector<KeepFault>& keep) {
  return std::any_of(keep.begin(), keep.end(), [&](const KeepFault& one) {
    return one.kind == fault.kind && (one.joint < 0 || one.joint == fault.joint);
  });
}

void draw_line(Eigen::Ref<VectorXd> x, const RowSpan& rows) {
  const Index before = rows.first - 1;
  const Index after = rows.last + 1;
  if (before < 0 && after >= x.size()) return;
  const double from = x[before < 0 ? after : before];
  const double to = x[after >= x.size() ? before : after];
  for (Index i = rows.first; i <= rows.last; ++i) {
    const double share = static_cast<double>(i - before) / static_cast<double>(after - before);
    x[i] = from + share * (to - from);
  }
}

// What a low-pass of the torque spreads of a stretch, in periods of its cut-off: a line over a
// small part of one is what was there, a torque at its limit was there, and of anything else a
// thousandth is left after three periods.
double spread_of(const DataFault& fault, const RowSpan& rows, const FilterPlan& plan) {
  constexpr double kShort = 1.0 / 3;    // of a torque
  constexpr double kShorter = 1.0 / 6;  // of a position, which is differentiated twice
  if (fault.kind == DataFaultKind::kSaturation) return 0.5;
  const double periods =
      static_cast<double>(rows.count()) * plan.torque_cutoff_hz / plan.sample_rate_hz;
  return periods <= (fault.signal == FaultySignal::kTorque ? kShort : kShorter) ? 0 : 3;
}

// Joints whose rigid-body torque depends on the position of one: would it stand still, they would
// have another.
std::vector<Index> depending_on(Index joint, const Log& log, const RobotDescription& robot) {
  constexpr double kShare = 0.02;
  constexpr Index kMostRows = 1000;
  const Index stride = std::max<Index>(1, log.sample_count() / kMostRows);
  Motion moves = thin_motion_of(log, usual_plan(log), stride);
  RobotDescription rigid = robot;
  rigid.effects.clear();
  const MatrixXd with = model_torque(rigid, moves);
  moves.q.col(joint).setConstant(moves.q.col(joint).mean());
  moves.dq.col(joint).setZero();
  moves.ddq.col(joint).setZero();
  const MatrixXd without = model_torque(rigid, moves);
  std::vector<Index> joints;
  for (Index j = 0; j < with.cols(); ++j) {
    const double by = (with.col(j) - without.col(j)).norm();
    if (j == joint ||
        !(by <= kShare * log.tau.col(j).norm() / std::sqrt(static_cast<double>(stride))))
      joints.push_back(j);
  }
  return joints;
}

// What a position would have done for most of the recording cannot be asked of it.
bool is_most_of(const DataFault& fault, const Log& log) {
  Index rows = 0;
  for (const FaultSpan& span : fault.spans) rows += span.samples.count();
  return 2 * rows > log.sample_count();
}

std::vector<Index> joints_without(const DataFault& fault, const Log& log,
                                  const RobotDescription& robot) {
  if (fault.joint >= 0 && fault.signal == FaultySignal::kTorque) return {fault.joint};
  if (fault.joint >= 0 && fault.signal == FaultySignal::kPosition && !is_most_of(fault, log)) {
    return depending_on(fault.joint, log, robot);
  }
  std::vector<Index> all(static_cast<std::size_t>(log.q.cols()));
  for (std::size_t joint = 0; joint < all.size(); ++joint) all[joint] = static_cast<Index>(joint);
  return all;
}

// A gap has no more samples than the grid between two rows: a straight line was put there.
void leave_out(const DataFault& fault, Log& log) {
  const FilterPlan plan = usual_plan(log);
  for (const FaultSpan& span : fault.spans) {
    if (span.samples.count() < 1) continue;
    const double spread = spread_of(fault, span.samples, plan);
    for (const Index joint : fault.left_out_of) {
      log.left_out.push_back({joint, span.samples, spread});
    }
  }
}

// A recording of which nothing is left, or some joints of it.
void say_what_is_left(const Log& log, std::vector<DataFault>& faults) {
  constexpr double kFewestS = 0.5;
  std::vector<Index> lost;
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const VectorXd usable = usable_samples(log, usual_plan(log), joint);
    if (usable.sum() * log.period_s < kFewestS) lost.push_back(joint);
  }
  if (lost.empty()) return;
  const bool all = static_cast<Index>(lost.size()) == log.q.cols();
  std::string why;
  std::string keep;
  for (const DataFault& fault : faults) {
    if (fault.left_out_of.empty()) continue;
    why += (why.empty() ? "" : "; ") + fault.words;
    const std::string option = "--keep " + keep_text_of(fault);
    if (keep.find(option) == std::string::npos) keep += (keep.empty() ? "" : " ") + option;
  }
  DataFault fault;
  fault.kind = DataFaultKind::kNothingLeft;
  fault.joint = all || lost.size() > 1 ? -1 : lost.front();
  fault.certain = all;
  fault.file = log.file;
  fault.words = fmt::format("nothing is left of {}: {}",
                            all ? std::string("the recording") : list_of_joints(lost), why);
  fault.mend = "record anew, or say what is no fault: " + keep;
  faults.push_back(std::move(fault));
}

}  // namespace

void bridge(const DataFault& fault, Log& log) {
  if (!is_treated(fault.kind) || fault.kind == DataFaultKind::kSaturation || fault.joint < 0)
    return;
  const bool torque = fault.signal == FaultySignal::kTorque;
  for (const FaultSpan& span : fault.spans) {
    draw_line(torque ? log.tau.col(fault.joint) : log.q.col(fault.joint), span.samples);
  }
}

std::vector<DataFault> treat(Log& log, const RobotDescription& robot,
                             const std::vector<KeepFault>& keep) {
  std::vector<DataFault> faults = examine(log, robot);
  bool derived = false;
  for (DataFault& fault : faults) {
    fault.overruled = is_kept(fault, keep);
    if (fault.overruled || fault.spans.empty() || !is_treated(fault.kind)) continue;
    bridge(fault, log);
    derived = derived || fault.signal == FaultySignal::kPosition;
  }
  for (DataFault& fault : faults) {
    if (fault.overruled || fault.spans.empty() || !is_treated(fault.kind)) continue;
    fault.left_out_of = joints_without(fault, log, robot);
    leave_out(fault, log);
  }
  if (derived) derive_velocities(log);
  if (!log.left_out.empty()) say_what_is_left(log, faults);
  return faults;
}

std::string keep_text_of(const DataFault& fault) {
  const std::string joint = fault.joint < 0 ? "all" : std::to_string(fault.joint + 1);
  return fmt::format("{}:{}", joint, name_of(fault.kind));
}

std::vector<std::string> keep_reasons() {
  std::vector<std::string> reasons;
  for (int kind = 0; kind < static_cast<int>(DataFaultKind::kNothingLeft); ++kind) {
    reasons.emplace_back(name_of(static_cast<DataFaultKind>(kind)));
  }
  return reasons;
}

KeepFault keep_fault_of(const std::string& text) {
  const std::vector<std::string> reasons = keep_reasons();
  const std::string form = "JOINT:REASON, such as 2:saturation or all:gaps";
  const auto colon = text.find(':');
  if (colon == std::string::npos) throw InputError({"--keep", "", "\"" + text + "\"", form, ""});
  const std::string joint = text.substr(0, colon);
  const std::string reason = text.substr(colon + 1);
  KeepFault keep;
  if (joint != "all") {
    constexpr std::size_t kMostDigits = 4;
    const bool number = !joint.empty() && joint.size() <= kMostDigits &&
                        joint.find_first_not_of("0123456789") == std::string::npos;
    keep.joint = number ? std::stol(joint) - 1 : -1;
    if (keep.joint < 0) {
      throw InputError({"--keep", "", "joint \"" + joint + "\"", "a joint from 1, or all", ""});
    }
  }
  const auto found = std::find(reasons.begin(), reasons.end(), reason);
  if (found == reasons.end()) {
    const std::string meant = nearest(reason, reasons);
    throw InputError({"--keep", "", "reason \"" + reason + "\"", list_of(reasons),
                      meant.empty() ? "" : "write " + joint + ":" + meant});
  }
  keep.kind = static_cast<DataFaultKind>(found - reasons.begin());
  return keep;
}

}  // namespace offnominal::desk
