#include "calibrate/calibrate_joints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "calibrate/calibrate_one.hpp"
#include "calibrate/recorded_error.hpp"
#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/list_of_joints.hpp"

namespace offnominal::desk {
namespace {

// [joint][recording]
using JointErrors = std::vector<std::vector<RecordedError>>;
using JointThresholds = std::vector<std::vector<Eigen::VectorXd>>;

OfFilters<JointErrors> errors_of(const RobotDescription& robot, const std::vector<Log>& logs,
                                 const std::vector<Log>& holdout) {
  OfFilters<JointErrors> errors;
  const auto append = [](std::vector<RecordedError> joints, JointErrors& to) {
    to.resize(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) to[i].push_back(std::move(joints[i]));
  };
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      OfFilters<std::vector<RecordedError>> joints = joint_errors(robot, log);
      append(std::move(joints.slow), errors.slow);
      append(std::move(joints.fast), errors.fast);
    }
  }
  return errors;
}

OfFilters<JointThresholds> thresholds_of(const RobotDescription& robot,
                                         const std::vector<Log>& logs,
                                         const std::vector<Log>& holdout) {
  OfFilters<JointThresholds> thresholds;
  const auto append = [](const Eigen::MatrixXd& of_joints, JointThresholds& to) {
    to.resize(static_cast<std::size_t>(of_joints.cols()));
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i].emplace_back(of_joints.col(static_cast<Eigen::Index>(i)));
    }
  };
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      const OfFilters<Eigen::MatrixXd> of_joints = joint_thresholds(robot, log);
      append(of_joints.slow, thresholds.slow);
      append(of_joints.fast, thresholds.fast);
    }
  }
  return thresholds;
}

JointBoundSettings joint_bound(const Calibration& calibration) {
  const BoundSettings& bound = *calibration.robot.bound;
  JointBoundSettings joint;
  joint.act_ratio = std::ceil(1000 * calibration.act_ratio) / 1000;
  if (bound.kind == BoundSettings::Kind::kTable) {
    joint.variable = bound.table.variable;
    joint.at = bound.table.at;
    joint.value = bound.table.value;
  } else {
    joint.value = {bound.constant.value};
  }
  return joint;
}

// The bounds of one filter, before they are judged.
struct FittedFilter {
  std::vector<CalibrationData> data;  // one per joint
  std::vector<Fitted> fits;
};

FittedFilter fitted_filter(const RobotDescription& robot, const CalibrateRequest& of_one,
                           JointErrors errors, std::size_t given, std::size_t judged,
                           const std::function<void()>& on_step,
                           std::vector<JointBoundSettings>& bounds) {
  FittedFilter filter;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    filter.data.push_back(
        data_of(std::move(errors[i]), given, static_cast<int>(i), judged, of_one.left_out));
    filter.fits.push_back(fitted(robot, of_one, filter.data[i], on_step));
    bounds.push_back(joint_bound(filter.fits[i].result));
  }
  return filter;
}

void collect(const std::string& joint, const std::vector<std::string>& from,
             std::vector<std::string>& into) {
  for (const std::string& words : from) into.push_back(fmt::format("{}: {}", joint, words));
}

// `fast`: which of the two filters it is.
std::vector<JointCalibration> judged_filter(FittedFilter filter, const CalibrateRequest& of_one,
                                            const JointThresholds& thresholds,
                                            const std::vector<JointBoundSettings>& bounds,
                                            bool fast, JointsCalibration& result) {
  std::vector<JointCalibration> joints;
  for (std::size_t i = 0; i < filter.data.size(); ++i) {
    JointCalibration& joint = joints.emplace_back();
    joint.name = result.robot.joints[i].name;
    const std::vector<RecordedError>& recordings = filter.data[i].recordings;
    joint.fault =
        smallest_fault(recordings, thresholds[i], bounds[i], recordings.front().alpha_per_s,
                       {of_one.fault_window_s, of_one.soon_window_s});
    joint.calibration =
        judged_calibration(std::move(filter.fits[i]), of_one, filter.data[i], thresholds[i]);
    const std::string place =
        fmt::format("joint {} ({}){}", i + 1, joint.name, fast ? ", fast filter" : "");
    collect(place, joint.calibration.notes, result.notes);
    collect(place, joint.calibration.objections, result.objections);
  }
  return joints;
}

std::string source_of(const CalibrateRequest& request, const JointsCalibration& result) {
  const FalseAlarmLevel& level = result.joints.front().calibration.level;
  std::int64_t alarms = 0;
  for (const auto* filter : {&result.joints, &result.fast}) {
    for (const JointCalibration& joint : *filter) {
      alarms += joint.calibration.level.held_out_alarms;
    }
  }
  return fmt::format(
      "{} {:g} false alarms per hour of all joints by extrapolation of the maxima of {}; on "
      "hold-out data {} in {:g} s.",
      request.source, result.alarms_per_hour, blocks_words(result),
      counted(static_cast<std::size_t>(alarms), "alarm"), level.held_out_s);
}

// That a second level is gone, or no higher than the first.
void note_levels(const CalibrateRequest& request, JointsCalibration& result) {
  if (!request.act_alarms_per_hour) {
    if (!result.old_bound || !result.old_bound->has_two_levels()) return;
    result.notes.emplace_back(
        "The old bound had a second level (act_ratio), the new one has none: the controller acts "
        "on "
        "every alarm. --act-alarms-per-hour finds another.");
    return;
  }
  const BoundSettings& bound = *result.robot.bound;
  std::vector<Eigen::Index> without;
  for (std::size_t i = 0; i < bound.joints.size(); ++i) {
    const bool fast = !bound.fast.empty() && bound.fast[i].act_ratio > 1;
    if (bound.joints[i].act_ratio <= 1 && !fast) without.push_back(static_cast<Eigen::Index>(i));
  }
  if (without.empty()) return;
  result.notes.push_back(fmt::format(
      "On {} the second level is the first: what the recordings ask for (their largest unseen "
      "residual, a start or a transient) is already rarer than {:g} per hour by the law of the "
      "maxima.",
      list_of_joints(without), *request.act_alarms_per_hour));
}

}  // namespace

std::string blocks_words(const JointsCalibration& calibration) {
  const auto words = [](const std::vector<JointCalibration>& of_filter) {
    const FalseAlarmLevel& level = of_filter.front().calibration.level;
    return fmt::format("{} blocks of {:g} s", level.blocks, level.block_s);
  };
  std::string slow = words(calibration.joints);
  if (calibration.fast.empty() || words(calibration.fast) == slow) return slow;
  return slow + ", behind the fast filter " + words(calibration.fast);
}

JointsCalibration calibrate_joints(const RobotDescription& robot, const CalibrateRequest& request,
                                   const std::vector<Log>& logs, const std::vector<Log>& holdout,
                                   const std::function<void()>& on_step) {
  if (request.velocity_error) {
    throw InputError({.file = "robot " + robot.name,
                      .place = "estimator.space = \"torque\"",
                      .found = "a velocity error",
                      .allowed = "none: what it adds to a joint's momentum depends on the others",
                      .mend = "leave --velocity-error out; it is found with the bounds"});
  }
  OfFilters<JointErrors> errors = errors_of(robot, logs, holdout);
  const std::size_t judged = errors.slow.size() + errors.fast.size();
  CalibrateRequest of_one = request;
  of_one.alarms_per_hour /= static_cast<double>(judged);
  if (of_one.act_alarms_per_hour) *of_one.act_alarms_per_hour /= static_cast<double>(judged);
  // What a measured velocity's error does to the momentum is in the residual, and no start has to
  // be covered by it.
  of_one.velocity_error = 0;
  JointsCalibration result;
  result.robot = robot;
  result.old_bound = robot.bound;
  result.alarms_per_hour = request.alarms_per_hour;
  result.act_alarms_per_hour = request.act_alarms_per_hour;
  BoundSettings& bound = result.robot.bound.emplace();
  bound.kind = BoundSettings::Kind::kPerJoint;
  bound.covers_velocities = have_velocities(logs, holdout);
  FittedFilter slow = fitted_filter(robot, of_one, std::move(errors.slow), logs.size(), judged,
                                    on_step, bound.joints);
  FittedFilter fast = fitted_filter(robot, of_one, std::move(errors.fast), logs.size(), judged,
                                    on_step, bound.fast);
  // The core itself runs over every recording again, with the new bounds.
  const OfFilters<JointThresholds> thresholds = thresholds_of(result.robot, logs, holdout);
  result.joints =
      judged_filter(std::move(slow), of_one, thresholds.slow, bound.joints, false, result);
  result.fast = judged_filter(std::move(fast), of_one, thresholds.fast, bound.fast, true, result);
  note_what_matters(robot, logs.size() + holdout.size(), result.notes);
  note_levels(request, result);
  result.robot.bound->source = source_of(request, result);
  return result;
}

}  // namespace offnominal::desk
