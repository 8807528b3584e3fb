#include "calibrate/calibrate_joints.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "calibrate/calibrate_one.hpp"
#include "calibrate/recorded_error.hpp"
#include "common/amount.hpp"
#include "common/error.hpp"

namespace offnominal::desk {
namespace {

// [joint][recording]
using JointErrors = std::vector<std::vector<RecordedError>>;

JointErrors errors_of(const RobotDescription& robot, const std::vector<Log>& logs,
                      const std::vector<Log>& holdout) {
  JointErrors errors(robot.joints.size());
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      std::vector<RecordedError> joints = joint_errors(robot, log);
      for (std::size_t i = 0; i < joints.size(); ++i) errors[i].push_back(std::move(joints[i]));
    }
  }
  return errors;
}

// [joint][recording]
std::vector<std::vector<Eigen::VectorXd>> thresholds_of(const RobotDescription& robot,
                                                        const std::vector<Log>& logs,
                                                        const std::vector<Log>& holdout) {
  std::vector<std::vector<Eigen::VectorXd>> thresholds(robot.joints.size());
  for (const auto* group : {&logs, &holdout}) {
    for (const Log& log : *group) {
      const Eigen::MatrixXd of_joints = joint_thresholds(robot, log);
      for (std::size_t i = 0; i < thresholds.size(); ++i) {
        thresholds[i].emplace_back(of_joints.col(static_cast<Eigen::Index>(i)));
      }
    }
  }
  return thresholds;
}

JointBoundSettings joint_bound(const BoundSettings& bound) {
  JointBoundSettings joint;
  if (bound.kind == BoundSettings::Kind::kTable) {
    joint.at = bound.table.at;
    joint.value = bound.table.value;
  } else {
    joint.value = {bound.constant.value};
  }
  return joint;
}

std::string source_of(const CalibrateRequest& request, const JointsCalibration& result) {
  const FalseAlarmLevel& level = result.joints.front().calibration.level;
  std::int64_t alarms = 0;
  for (const JointCalibration& joint : result.joints) {
    alarms += joint.calibration.level.held_out_alarms;
  }
  return fmt::format(
      "{} {:g} false alarms per hour of all joints by extrapolation of {} block maxima of {:g} s "
      "each; on hold-out data {} in {:g} s.",
      request.source, result.alarms_per_hour, level.blocks, level.block_s,
      counted(static_cast<std::size_t>(alarms), "alarm"), level.held_out_s);
}

void collect(const std::string& joint, const std::vector<std::string>& from,
             std::vector<std::string>& into) {
  for (const std::string& words : from) into.push_back(fmt::format("{}: {}", joint, words));
}

}  // namespace

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
  const std::size_t count = robot.joints.size();
  CalibrateRequest of_one = request;
  of_one.alarms_per_hour /= static_cast<double>(count);
  // What a measured velocity's error does to the momentum is in the residual, and no start has to
  // be covered by it.
  of_one.velocity_error = 0;
  JointErrors errors = errors_of(robot, logs, holdout);
  std::vector<CalibrationData> data;
  std::vector<Fitted> fits;
  JointsCalibration result;
  result.robot = robot;
  result.old_bound = robot.bound;
  result.alarms_per_hour = request.alarms_per_hour;
  BoundSettings& bound = result.robot.bound.emplace();
  bound.kind = BoundSettings::Kind::kPerJoint;
  for (std::size_t i = 0; i < count; ++i) {
    data.push_back(data_of(std::move(errors[i]), logs.size(), robot.estimator.alpha,
                           static_cast<int>(i), count, request.left_out));
    fits.push_back(fitted(robot, of_one, data[i], on_step));
    bound.joints.push_back(joint_bound(*fits[i].result.robot.bound));
  }
  // The core itself runs over every recording again, with the new bounds.
  const auto thresholds = thresholds_of(result.robot, logs, holdout);
  for (std::size_t i = 0; i < count; ++i) {
    JointCalibration& joint = result.joints.emplace_back();
    joint.name = robot.joints[i].name;
    joint.fault = smallest_fault(data[i].recordings, thresholds[i], bound.joints[i],
                                 robot.estimator.alpha, request.fault_window_s);
    joint.calibration = judged_calibration(std::move(fits[i]), of_one, data[i], thresholds[i]);
    const std::string place = fmt::format("joint {} ({})", i + 1, joint.name);
    collect(place, joint.calibration.notes, result.notes);
    collect(place, joint.calibration.objections, result.objections);
  }
  note_what_matters(robot, logs.size() + holdout.size(), result.notes);
  result.robot.bound->source = source_of(request, result);
  return result;
}

}  // namespace offnominal::desk
