#include "motion/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "compare/inverse_model.hpp"

namespace offnominal::desk::motion {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// What a robot file without a limit stands for (chain.hpp).
constexpr double kNoLimit = std::numeric_limits<double>::max();

[[noreturn]] void refuse(const RobotDescription& robot, std::size_t joint, const std::string& what,
                         const std::string& key) {
  throw InputError({robot.name, fmt::format("joint {}", joint + 1), "no " + what,
                    what + " that the motion may use",
                    fmt::format("write {} under [joint.limits] of this joint", key)});
}

// The largest share of its limit that the torque takes.
double torque_excess(const MatrixXd& torque, const std::vector<JointLimits>& limits) {
  double worst = 0;
  for (Index joint = 0; joint < torque.cols() && torque.rows() > 0; ++joint) {
    worst = std::max(worst, torque.col(joint).cwiseAbs().maxCoeff() /
                                limits[static_cast<std::size_t>(joint)].torque);
  }
  return worst;
}

// The largest factor (to 1 %) on the distance from home whose torque is allowed, for the rows from
// `from` to before `to`; 0: standing still at home.
double largest_share(const RobotDescription& robot, const Motion& motion,
                     const std::vector<JointScale>& scale, const std::vector<JointLimits>& limits,
                     Index from, Index to) {
  const Index rows = to - from;
  const Motion part{motion.t_s.segment(from, rows), motion.q.middleRows(from, rows),
                    motion.dq.middleRows(from, rows), motion.ddq.middleRows(from, rows)};
  Eigen::RowVectorXd home(motion.q.cols());
  for (Index j = 0; j < home.size(); ++j) home[j] = scale[static_cast<std::size_t>(j)].home;
  const auto fits = [&](double share) {
    Motion smaller = part;
    smaller.q = (share * (part.q.rowwise() - home)).rowwise() + home;
    smaller.dq *= share;
    smaller.ddq *= share;
    return torque_excess(model_torque(robot, smaller), limits) <= 1;
  };
  if (rows == 0 || fits(1)) return 1;
  double low = 0;
  double high = 1;
  constexpr double kClose = 0.01;
  while (high - low > kClose) {
    const double middle = (low + high) / 2;
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

JointScale scale_of(const JointPlan& plan, const JointLimits& limits, const PlanParts& parts,
                    Index joint) {
  JointScale scale;
  scale.home =
      std::clamp(limits.middle() + plan.home * limits.half_range(), limits.low, limits.high);
  const auto x = parts.oscillation.q.col(joint);
  const auto fit = [](double room, double need) { return need > 0 ? room / need : kNoLimit; };
  const double most = std::min(
      {fit(limits.high - scale.home, x.maxCoeff()), fit(scale.home - limits.low, -x.minCoeff()),
       fit(limits.velocity, parts.oscillation.dq.col(joint).cwiseAbs().maxCoeff())});
  // A hair less, since sums are rounded.
  constexpr double kRounding = 1 - 1e-9;
  scale.oscillation = most < kNoLimit ? kRounding * plan.reach * most : 0;
  scale.poses = kRounding * std::min(1.0, fit(limits.velocity,
                                              parts.poses.dq.col(joint).cwiseAbs().maxCoeff()));
  return scale;
}

}  // namespace

std::vector<JointLimits> limits_of(const RobotDescription& robot, double margin) {
  std::vector<JointLimits> all;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint<double>& joint = robot.joints[j].joint;
    if (!(joint.max_position < kNoLimit) || !(joint.min_position > -kNoLimit)) {
      refuse(robot, j, "position limits", "position = [low, high]");
    }
    if (!(joint.max_velocity < kNoLimit)) refuse(robot, j, "velocity limit", "velocity");
    if (!(joint.max_torque < kNoLimit)) refuse(robot, j, "torque limit", "torque");
    const double left = (joint.max_position - joint.min_position) * margin / 2;
    all.push_back({joint.min_position + left, joint.max_position - left,
                   (1 - margin) * joint.max_velocity, (1 - margin) * joint.max_torque});
  }
  return all;
}

std::optional<FittedMotion> fit_into_limits(const RobotDescription& robot, const MotionPlan& plan,
                                            const std::vector<JointLimits>& limits,
                                            double duration_s, double rate_hz) {
  std::vector<double> half_range;
  for (const JointLimits& one : limits) half_range.push_back(one.half_range());
  const PlanParts parts = parts_of(plan, half_range, duration_s, rate_hz);
  std::vector<JointScale> scale;
  for (std::size_t j = 0; j < limits.size(); ++j) {
    scale.push_back(scale_of(plan.joints[j], limits[j], parts, static_cast<Index>(j)));
  }
  // The two stretches do not share a sample, so each is made as much smaller as its own torque
  // asks for.
  const Motion full = combined(parts, scale);
  const double fast = largest_share(robot, full, scale, limits, 0, parts.slow_at);
  const double slow = largest_share(robot, full, scale, limits, parts.slow_at, full.sample_count());
  for (JointScale& one : scale) {
    one.oscillation *= fast;
    one.poses *= slow;
  }
  FittedMotion fitted{combined(parts, scale), {}};
  fitted.torque = model_torque(robot, fitted.motion);
  if (torque_excess(fitted.torque, limits) > 1) return std::nullopt;
  return fitted;
}

}  // namespace offnominal::desk::motion
