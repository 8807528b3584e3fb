#include "explain/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"
#include "explain/doctor_checks.hpp"
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
  }
  return "";
}

bool spoils(const DataFault& fault, RestsOn what) {
  if (!fault.certain) return false;
  switch (fault.kind) {
    case DataFaultKind::kDegrees:
    case DataFaultKind::kTorqueSign:
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

std::optional<TorquePair> torque_pair(const Log& log, const RobotDescription& robot,
                                      double cutoff_of_rate) {
  // Robots move below this; above it the second derivative of a coarse encoder outweighs the
  // torque.
  constexpr double kCutoffHz = 5;
  constexpr double kCutoffOfRate = 0.1;     // for slow logs
  constexpr double kSamplesPerCutoff = 16;  // kept of every period of the cut-off
  constexpr double kShortestPeriods =
      8;  // of the cut-off; the filter's ends spoil one on each side
  const double rate_hz = log.sample_rate_hz();
  TorquePair pair;
  pair.cutoff_hz =
      cutoff_of_rate > 0 ? cutoff_of_rate * rate_hz : std::min(kCutoffHz, kCutoffOfRate * rate_hz);
  const auto rows_per_period = static_cast<Index>(std::ceil(rate_hz / pair.cutoff_hz));
  if (static_cast<double>(log.sample_count()) <
      kShortestPeriods * static_cast<double>(rows_per_period)) {
    return std::nullopt;
  }
  FilterPlan plan;
  plan.sample_rate_hz = rate_hz;
  plan.position_cutoff_hz = 2 * pair.cutoff_hz;
  const Motion full = motion_of(log, plan);
  const auto stride =
      std::max<Index>(1, static_cast<Index>(rate_hz / (kSamplesPerCutoff * pair.cutoff_hz)));
  pair.period_s = log.period_s * static_cast<double>(stride);
  const Index edge = rows_per_period / stride + 1;
  const auto smooth = [&](const MatrixXd& thin) {
    MatrixXd result(thin.rows() - 2 * edge, thin.cols());
    for (Index joint = 0; joint < thin.cols(); ++joint) {
      result.col(joint) = zero_phase_low_pass(thin.col(joint), pair.cutoff_hz, 1 / pair.period_s)
                              .segment(edge, result.rows());
    }
    return result;
  };
  const Motion thin{every_nth(full.t_s, stride), every_nth_row(full.q, stride),
                    every_nth_row(full.dq, stride), every_nth_row(full.ddq, stride)};
  MatrixXd torque = log.tau;
  for (Index joint = 0; joint < torque.cols(); ++joint) {
    torque.col(joint) = zero_phase_low_pass(log.tau.col(joint), plan.position_cutoff_hz, rate_hz);
  }
  RobotDescription rigid = robot;
  rigid.effects.clear();
  rigid = carrying(rigid, log.payload);
  pair.measured = smooth(every_nth_row(torque, stride));
  pair.model = smooth(model_torque(carrying(robot, log.payload), thin));
  pair.load = smooth(model_torque(rigid, thin));
  for (std::size_t link = 0; link < robot.joints.size(); ++link) {
    pair.links.push_back(smooth(link_torque(robot, link, thin)));
  }
  pair.t_s = thin.t_s.segment(edge, pair.measured.rows());
  pair.q = smooth(thin.q);
  pair.dq = smooth(thin.dq);
  pair.ddq = smooth(thin.ddq);
  if (!pair.measured.allFinite() || !pair.model.allFinite()) return std::nullopt;
  return pair;
}

void find_gaps(const Log& log, std::vector<DataFault>& faults) {
  // One lost row makes a step of two periods; clocks of an ordinary computer stay below this.
  constexpr double kLongestStep = 1.5;
  const Sampling sampling = sampling_of(log.t_s);
  const double steps = sampling.largest_gap_s / sampling.median_period_s;
  if (!(steps > kLongestStep)) return;
  DataFault fault;
  fault.kind = DataFaultKind::kGaps;
  fault.size = sampling.largest_gap_s;
  fault.unit = "s";
  fault.words = fmt::format(
      "the time stamps are not even: {:.4g} s between samples mostly, but {:.4g} s after t = "
      "{:.6g} "
      "s",
      sampling.median_period_s, sampling.largest_gap_s, sampling.largest_gap_at_s);
  fault.mend = "record without losing samples, or cut the recording at its gaps";
  faults.push_back(std::move(fault));
}

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
  find_gaps(mended, faults);
  find_stale_samples(mended, faults);
  find_stuck_encoders(mended, robot, faults);
  find_saturation(mended, robot, faults);
  mend_degrees(mended, robot, faults);
  mend_strange_velocities(mended, robot, faults);
  mend_velocities(mended, robot, faults);
  if (const auto pair = torque_pair(mended, robot)) {
    find_torque_sign(mended, *pair, faults);
    find_clock_skew(mended, *pair, faults);
  }
  for (DataFault& fault : faults) fault.file = log.file;
  return faults;
}

}  // namespace offnominal::desk
