#include "calibrate/recorded_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "common/error.hpp"
#include "replay/replay.hpp"

namespace offnominal::desk {
namespace {

// Without learning the network's output stays exactly zero, whatever its size; one unit is the
// cheapest. A robot without a bound gets one, which e does not depend on.
RobotDescription without_learning(RobotDescription robot) {
  robot.estimator.learning_rate = 0;
  robot.estimator.hidden_units = 1;
  if (robot.bound) return robot;
  BoundSettings& bound = robot.bound.emplace();
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    bound.kind = BoundSettings::Kind::kPerJoint;
    bound.joints.resize(robot.joints.size());
    if (robot.estimator.fast_alpha > 0) bound.fast.resize(robot.joints.size());
  }
  return robot;
}

void require_all_accepted(const Replay& replay) {
  if (replay.refused.empty()) return;
  const auto& [status, refusals] = *replay.refused.begin();
  throw InputError(
      {.file = replay.log,
       .place = fmt::format("time {:.3f} s", refusals.first_s),
       .found = fmt::format("{} sample(s) refused with status {}", refusals.count, status),
       .allowed = "a recording of which the monitor accepts every sample",
       .mend = "check the units, [channels] and [joint.limits]; leave out a recording "
               "in which something went wrong"});
}

std::shared_ptr<const RecordedSignals> signals_of(const Log& log) {
  return std::make_shared<const RecordedSignals>(RecordedSignals{log.q, log.dq, log.tau});
}

Eigen::VectorXi loudest_joints(const Eigen::MatrixXd& error) {
  Eigen::VectorXi loudest(error.rows());
  for (Eigen::Index i = 0; i < error.rows(); ++i) {
    Eigen::Index joint = 0;
    error.row(i).cwiseAbs().maxCoeff(&joint);
    loudest[i] = static_cast<int>(joint);
  }
  return loudest;
}

}  // namespace

std::vector<StartBefore> starts_before(const TickFilter<double>& filter) {
  // Between a start and the next one asked for neither |e| nor its threshold moves far.
  constexpr double kFurther = 1.5;
  constexpr double kForgotten = 0.05;
  std::vector<StartBefore> starts;
  double kept = 1;
  for (Eigen::Index ticks = 1; kept > kForgotten;
       ticks =
           std::max(ticks + 1, static_cast<Eigen::Index>(kFurther * static_cast<double>(ticks)))) {
    kept = std::pow(filter.keep, static_cast<double>(ticks));
    starts.push_back({ticks, kept});
  }
  return starts;
}

Eigen::VectorXd RecordedError::error_norm_after(const StartBefore& start, Eigen::Index begin,
                                                Eigen::Index end) const {
  Eigen::VectorXd norms = Eigen::VectorXd::Zero(end - begin);
  const Eigen::Index first = std::max(begin, start.ticks);
  if (first >= end) return norms;
  const Eigen::Index rows = end - first;
  norms.tail(rows) =
      (error.middleRows(first, rows) - start.kept * error.middleRows(first - start.ticks, rows))
          .rowwise()
          .norm();
  return norms;
}

RecordedError recorded_error(const RobotDescription& robot, const Log& log) {
  const Replay run = replay(without_learning(robot), log);
  require_all_accepted(run);
  RecordedError recorded;
  recorded.file = log.file;
  recorded.unit = run.unit;
  recorded.period_s = log.period_s;
  recorded.alpha_per_s = robot.estimator.alpha;
  recorded.t_s = run.t_s;
  recorded.error = run.error;
  recorded.error_norm = run.error_norm;
  recorded.loudest_joint = loudest_joints(run.error);
  if (robot.bound) recorded.old_threshold = run.threshold;
  recorded.signals = signals_of(log);
  return recorded;
}

OfFilters<std::vector<RecordedError>> joint_errors(const RobotDescription& robot, const Log& log) {
  const Replay run = replay(without_learning(robot), log);
  require_all_accepted(run);
  const auto signals = signals_of(log);
  const auto behind = [&](double alpha_per_s, const Eigen::MatrixXd& errors,
                          const Eigen::MatrixXd& thresholds) {
    std::vector<RecordedError> joints;
    for (Eigen::Index joint = 0; joint < errors.cols(); ++joint) {
      RecordedError& recorded = joints.emplace_back();
      recorded.file = log.file;
      recorded.unit = run.joints[static_cast<std::size_t>(joint)].unit;
      recorded.period_s = log.period_s;
      recorded.alpha_per_s = alpha_per_s;
      recorded.t_s = run.t_s;
      recorded.error = errors.col(joint);
      recorded.error_norm = recorded.error.cwiseAbs();
      recorded.loudest_joint = Eigen::VectorXi::Constant(errors.rows(), static_cast<int>(joint));
      if (robot.bound) recorded.old_threshold = thresholds.col(joint);
      recorded.signals = signals;
      recorded.scale = alpha_per_s;
      recorded.of_one_joint = true;
    }
    return joints;
  };
  return {behind(robot.estimator.alpha, run.error, run.thresholds),
          behind(robot.estimator.fast_alpha, run.fast_error, run.fast_thresholds)};
}

OfFilters<Eigen::MatrixXd> joint_thresholds(const RobotDescription& robot, const Log& log) {
  Replay run = replay(without_learning(robot), log);
  return {std::move(run.thresholds), std::move(run.fast_thresholds)};
}

}  // namespace offnominal::desk
