#include "compare/measurement.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/error.hpp"
#include "compare/inverse_model.hpp"
#include "compare/standstill.hpp"
#include "compare/transmission.hpp"
#include "compare/usable.hpp"
#include "log/seen_by_sensor.hpp"
#include "robot/payload.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

MatrixXd filtered_columns(const FilterPlan& plan, const MatrixXd& columns) {
  MatrixXd result;
  for (Index joint = 0; joint < columns.cols(); ++joint) {
    const VectorXd column = filtered(plan, columns.col(joint));
    if (joint == 0) result.resize(column.size(), columns.cols());
    result.col(joint) = column;
  }
  return result;
}

// Of the measured torque, per joint.
VectorXd noise_densities(const Measurement& measured) {
  VectorXd densities(measured.log.tau.cols());
  const MatrixXd usable = usable_samples(measured.log, measured.plan);
  for (Index joint = 0; joint < densities.size(); ++joint) {
    const VectorXd raw = measured.log.tau.col(joint);
    densities[joint] = noise_density(
        raw,
        zero_phase_low_pass(raw, measured.plan.position_cutoff_hz, measured.plan.sample_rate_hz),
        usable.size() > 0 ? VectorXd(usable.col(joint)) : VectorXd(), measured.plan);
  }
  return densities;
}

void leave_out_faults(const Log& log, Measurement& measured) {
  measured.at_fault = VectorXd::Zero(measured.moving.cols());
  const MatrixXd usable = usable_samples(log, measured.plan);
  if (usable.size() == 0) return;
  for (Index joint = 0; joint < usable.cols(); ++joint) {
    const VectorXd kept = kept_samples(measured.plan, usable.col(joint));
    measured.at_fault[joint] = 1 - kept.mean();
    measured.moving.col(joint).array() *= kept.array();
    // Where all that is left stands still, rest is all there is (as in standstill.cpp).
    if (!(measured.moving.col(joint).sum() > 0)) measured.moving.col(joint) = kept;
  }
  if (measured.moving.sum() > 0) return;
  throw InputError({log.file, "",
                    "nothing that is free of faults and of what a filter spreads of them",
                    "a stretch of some seconds of one joint at least",
                    "record anew, or overrule with --keep JOINT:REASON what is no fault"});
}

}  // namespace

void require_joints(const Log& log, const RobotDescription& robot) {
  if (log.joint_count() == robot.joint_count()) return;
  throw InputError({log.file, "", fmt::format("{} joints", log.joint_count()),
                    fmt::format("{}, as the robot has", robot.joint_count()),
                    "give the robot file that belongs to this recording, or [channels]"});
}

Measurement measure(Log log, const RobotDescription& robot, const FilterPlan& plan) {
  require_joints(log, robot);
  Measurement measured;
  measured.plan = plan_for(log, plan);
  measured.motion = motion_of(log, measured.plan);
  measured.t_s = kept_samples(measured.plan, log.t_s);
  measured.torque = filtered_columns(measured.plan, log.tau);
  if (log.sensor_tau.rows() > 0) {
    measured.sensor_torque = filtered_columns(measured.plan, log.sensor_tau);
  }
  const MatrixXd moving = samples_that_tell(log, robot, measured.motion);
  measured.moving.resize(measured.t_s.size(), moving.cols());
  for (Index joint = 0; joint < moving.cols(); ++joint) {
    measured.moving.col(joint) = kept_samples(measured.plan, moving.col(joint));
  }
  leave_out_faults(log, measured);
  measured.log = std::move(log);
  return measured;
}

Measurement measure(Log log, const RobotDescription& robot, const FilterRequest& request) {
  const FilterPlan plan = plan_filter({log}, robot, request);
  return measure(std::move(log), robot, plan);
}

MatrixXd filtered_model_torque(const RobotDescription& robot, const Measurement& measured) {
  return ModelTorqueMemory().filtered(robot, measured);
}

MatrixXd ModelTorqueMemory::filtered(const RobotDescription& robot, const Measurement& measured) {
  const RobotDescription seen =
      seen_by_sensors(carrying(robot, measured.log.payload), measured.log);
  MatrixXd torque = model_torque(seen, measured.motion, bodies_);
  if (has_transmission_effect(seen)) {
    torque += transmission_torque(seen, measured.motion, torque, measured.log.tau,
                                  noise_densities(measured), measured.plan);
  }
  MatrixXd result = filtered_;
  if (torque_.rows() != torque.rows() || torque_.cols() != torque.cols()) {
    result = filtered_columns(measured.plan, torque);
  } else {
    for (Index joint = 0; joint < torque.cols(); ++joint) {
      if (torque.col(joint) == torque_.col(joint)) continue;
      result.col(joint) = desk::filtered(measured.plan, torque.col(joint));
    }
  }
  // Both or none of them, whatever throws above.
  torque_ = std::move(torque);
  filtered_ = result;
  return result;
}

}  // namespace offnominal::desk
