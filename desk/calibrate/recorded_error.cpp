#include "calibrate/recorded_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

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

TickFilter tick_filter(double alpha_per_s, double period_s) {
  const auto step = [&](double y, double x_begin, double x_end) {
    const double h = period_s;
    const double x_middle = 0.5 * (x_begin + x_end);
    const double k1 = x_begin - alpha_per_s * y;
    const double k2 = x_middle - alpha_per_s * (y + 0.5 * h * k1);
    const double k3 = x_middle - alpha_per_s * (y + 0.5 * h * k2);
    const double k4 = x_end - alpha_per_s * (y + h * k3);
    return y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  };
  return {step(1, 0, 0), step(0, 1, 0), step(0, 0, 1)};
}

std::vector<StartBefore> starts_before(const TickFilter& filter) {
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
  recorded.t_s = run.t_s;
  recorded.error = run.error;
  recorded.error_norm = run.error_norm;
  recorded.loudest_joint = loudest_joints(run.error);
  if (robot.bound) recorded.old_threshold = run.threshold;
  recorded.signals = signals_of(log);
  return recorded;
}

std::vector<RecordedError> joint_errors(const RobotDescription& robot, const Log& log) {
  const Replay run = replay(without_learning(robot), log);
  require_all_accepted(run);
  const auto signals = signals_of(log);
  std::vector<RecordedError> joints;
  for (Eigen::Index joint = 0; joint < run.error.cols(); ++joint) {
    RecordedError& recorded = joints.emplace_back();
    recorded.file = log.file;
    recorded.unit = run.joints[static_cast<std::size_t>(joint)].unit;
    recorded.period_s = log.period_s;
    recorded.t_s = run.t_s;
    recorded.error = run.error.col(joint);
    recorded.error_norm = recorded.error.cwiseAbs();
    recorded.loudest_joint = Eigen::VectorXi::Constant(run.error.rows(), static_cast<int>(joint));
    if (robot.bound) recorded.old_threshold = run.thresholds.col(joint);
    recorded.signals = signals;
    recorded.scale = robot.estimator.alpha;
    recorded.of_one_joint = true;
  }
  return joints;
}

Eigen::MatrixXd joint_thresholds(const RobotDescription& robot, const Log& log) {
  return replay(without_learning(robot), log).thresholds;
}

}  // namespace offnominal::desk
