#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "discovery/doctor_checks.hpp"
#include "discovery/standstill.hpp"

namespace offnominal::tools::discovery {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kRadPerDegree = std::numbers::pi / 180;

// Error of the model on a joint as a share of its torque, whatever the torque's sign: both faults
// may be there at once.
double misfit(const TorquePair& pair, Index joint) {
  const double torque = pair.measured.col(joint).norm();
  if (!(torque > 0)) return 0;
  return std::min((pair.measured.col(joint) - pair.model.col(joint)).norm(),
                  (pair.measured.col(joint) + pair.model.col(joint)).norm()) /
         torque;
}

double misfit(const TorquePair& pair) {
  double sum = 0;
  for (Index joint = 0; joint < pair.measured.cols(); ++joint) {
    sum += std::pow(misfit(pair, joint), 2);
  }
  return std::sqrt(sum / static_cast<double>(pair.measured.cols()));
}

Log in_radians(const Log& log, const RobotDescription& robot, Index joint) {
  Log scaled = log;
  for (Index j = 0; j < log.q.cols(); ++j) {
    if (joint >= 0 && j != joint) continue;
    if (robot.joints[static_cast<std::size_t>(j)].joint.type != JointType::kRevolute) continue;
    scaled.q.col(j) *= kRadPerDegree;
    if (j < log.dq.cols()) scaled.dq.col(j) *= kRadPerDegree;
  }
  return scaled;
}

bool leaves_limits(const Log& log, const RobotDescription& robot, Index joint) {
  // A joint may overshoot its limits, but not by as much as they are apart.
  constexpr double kBeyond = 1;
  const auto& limits = robot.joints[static_cast<std::size_t>(joint)].joint;
  const double width = limits.max_position - limits.min_position;
  if (!(width < std::numeric_limits<double>::max())) return false;
  return log.q.col(joint).maxCoeff() > limits.max_position + kBeyond * width ||
         log.q.col(joint).minCoeff() < limits.min_position - kBeyond * width;
}

bool inside_limits(const Log& log, const RobotDescription& robot, Index joint) {
  const auto& limits = robot.joints[static_cast<std::size_t>(joint)].joint;
  return log.q.col(joint).maxCoeff() * kRadPerDegree <= limits.max_position &&
         log.q.col(joint).minCoeff() * kRadPerDegree >= limits.min_position;
}

}  // namespace

Log without_degrees(const Log& log, const RobotDescription& robot, std::vector<DataFault>& faults) {
  // As radians the model must miss most of the torque: missing effects make up 15 %.
  constexpr double kBadFit = 0.6;
  // As degrees it must fit, although effects are missing or a clock is off.
  constexpr double kGoodFit = 0.5;
  // And fit far better.
  constexpr double kBetter = 3;
  std::vector<Index> revolute;
  for (Index j = 0; j < log.q.cols(); ++j) {
    if (robot.joints[static_cast<std::size_t>(j)].joint.type == JointType::kRevolute) {
      revolute.push_back(j);
    }
  }
  if (revolute.empty()) return log;
  std::string reason;
  Index which = -1;
  bool found = false;
  if (const auto as_is = torque_pair(log, robot); as_is && misfit(*as_is) > kBadFit) {
    std::vector<Index> choices{-1};
    if (revolute.size() > 1) choices.insert(choices.end(), revolute.begin(), revolute.end());
    double best = std::min(kGoodFit, misfit(*as_is) / kBetter);
    for (const Index joint : choices) {
      const auto scaled = torque_pair(in_radians(log, robot, joint), robot);
      if (!scaled || !(misfit(*scaled) < best)) continue;
      best = misfit(*scaled);
      which = joint;
      found = true;
    }
    reason = fmt::format(
        "the model misses {:.0f} % of the torque with the positions as they are, {:.0f} % with the "
        "positions times pi/180",
        std::min(100 * misfit(*as_is), 1e4), 100 * best);
  }
  if (!found) {
    std::vector<Index> beyond;
    for (const Index joint : revolute) {
      if (leaves_limits(log, robot, joint) && inside_limits(log, robot, joint)) {
        beyond.push_back(joint);
      }
    }
    if (beyond.empty()) return log;
    found = true;
    which = beyond.size() == 1 && revolute.size() > 1 ? beyond.front() : -1;
    reason = fmt::format("positions of joint {} go from {:.4g} to {:.4g}, far beyond its limits",
                         beyond.front() + 1, log.q.col(beyond.front()).minCoeff(),
                         log.q.col(beyond.front()).maxCoeff());
  }
  DataFault fault;
  fault.kind = DataFaultKind::kDegrees;
  fault.joint = which;
  fault.size = 1 / kRadPerDegree;
  fault.words = fmt::format("the positions of {} are in degrees: {}", joint_words(which), reason);
  fault.mend = "log radians, or scale the position channel by 0.0174533 in the robot's [channels]";
  faults.push_back(std::move(fault));
  return in_radians(log, robot, which);
}

void find_torque_sign(const TorquePair& pair, std::vector<DataFault>& faults) {
  // The model with the opposite sign must fit: missing effects and a clock that is off leave less.
  constexpr double kGoodFit = 0.6;
  // Where the model explains less than this share of the torque it has nothing to say about the
  // sign, and friction has: its power is never negative.
  constexpr double kSilentModel = 0.3;
  // Correlation of what the model does not explain with the velocity; friction of any kind has
  // +0.8.
  constexpr double kClearBraking = -0.6;
  const Index joints = pair.measured.cols();
  std::vector<DataFault> found;
  for (Index joint = 0; joint < joints; ++joint) {
    const VectorXd tau = pair.measured.col(joint);
    const VectorXd model = pair.model.col(joint);
    const double size = tau.norm();
    if (!(size > 0)) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kTorqueSign;
    fault.joint = joint;
    if (model.norm() > kSilentModel * size) {
      const double turned = (tau + model).norm() / size;
      if (!(turned < kGoodFit) || !((tau - model).norm() > size)) continue;
      fault.size = tau.dot(model) / model.squaredNorm();
      fault.words = fmt::format(
          "the torque of joint {} has the wrong sign: measured against model torque has slope "
          "{:.2f}, and the opposite sign leaves {:.0f} % of it unexplained instead of {:.0f} %",
          joint + 1, fault.size, 100 * turned, 100 * (tau - model).norm() / size);
    } else {
      const VectorXd rest = tau - pair.load.col(joint);
      const VectorXd speed = pair.dq.col(joint);
      const double product = rest.norm() * speed.norm();
      if (!(product > 0) || !(rest.dot(speed) / product < kClearBraking)) continue;
      fault.size = rest.dot(speed) / speed.squaredNorm();
      fault.words = fmt::format(
          "the torque of joint {} has the wrong sign: it acts against the motion (correlation with "
          "the velocity {:.2f}), as if friction gave power",
          joint + 1, rest.dot(speed) / product);
    }
    fault.mend = fmt::format(
        "turn the sign of the torque channel of joint {} (scale = -1), or its position's; or "
        "gravity in the robot file points the wrong way",
        joint + 1);
    found.push_back(std::move(fault));
  }
  faults.insert(faults.end(), found.begin(), found.end());
}

namespace {

// Of a joint that stands still friction holds a part: its torque stays what it is, at no limit.
VectorXd while_moving(const Log& log, const RobotDescription& robot, Index joint) {
  const VectorXd moving = moving_samples(
      log, joint, robot.joints[static_cast<std::size_t>(joint)].encoder.counts_per_unit);
  std::vector<double> kept;
  for (Index i = 0; i < moving.size(); ++i) {
    if (moving[i] > 0) kept.push_back(log.tau(i, joint));
  }
  return Eigen::Map<const VectorXd>(kept.data(), static_cast<Index>(kept.size()));
}

}  // namespace

void find_saturation(const Log& log, const RobotDescription& robot,
                     std::vector<DataFault>& faults) {
  // An extreme value counts as reached within this share of the torque's range.
  constexpr double kNearExtreme = 1e-3;
  // A sine spends 2 % of its time so near to its peaks, but a third as much just below.
  constexpr double kSmallestShareAtExtreme = 0.01;
  constexpr double kAgainstNext = 5;
  // Where torque is at its extremes most of the time, it switches between two levels: dry friction.
  constexpr double kLargestShareAtExtreme = 0.5;
  constexpr double kAtLimit = 0.98;
  // A drive's limits are not that far apart: a joint that waits where little is asked of it stays
  // near zero, and that is the lowest value where all of its torques have one sign.
  constexpr double kSmallestOfLargest = 0.3;
  for (Index joint = 0; joint < log.tau.cols(); ++joint) {
    const VectorXd tau = while_moving(log, robot, joint);
    const double low = tau.minCoeff();
    const double high = tau.maxCoeff();
    const double near = kNearExtreme * (high - low);
    if (!(near > 0)) continue;
    const double limit = robot.joints[static_cast<std::size_t>(joint)].joint.max_torque;
    const auto rows = static_cast<double>(tau.size());
    double share = 0;
    double at = 0;
    bool at_limit = false;
    for (const double end : {low, high}) {
      if (std::abs(end) < kSmallestOfLargest * std::max(std::abs(low), std::abs(high))) continue;
      const auto distance = (tau.array() - end).abs();
      const auto reached = static_cast<double>((distance <= near).count());
      const auto next = static_cast<double>((distance <= 2 * near).count()) - reached;
      if (reached < kSmallestShareAtExtreme * rows || reached < kAgainstNext * (next + 1)) continue;
      if (reached > share * rows) at = end;
      share += reached / rows;
      at_limit = at_limit || std::abs(end) >= kAtLimit * limit;
    }
    if (!(share > 0) || (share > kLargestShareAtExtreme && !at_limit)) continue;
    DataFault fault;
    fault.kind = DataFaultKind::kSaturation;
    fault.joint = joint;
    fault.size = share;
    fault.words = fmt::format("the torque of joint {} stays at {:.4g} in {:.1f} % of the samples",
                              joint + 1, at, 100 * share);
    fault.mend = "move more gently, or leave the samples out in which the drive is at its limit";
    faults.push_back(std::move(fault));
  }
}

}  // namespace offnominal::tools::discovery
