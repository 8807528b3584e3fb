#include "compare/measurement.hpp"

#include <fmt/format.h>

#include <utility>

#include "common/error.hpp"
#include "common/parallel.hpp"
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

// On several threads where it is long.
MatrixXd filtered_columns(const FilterPlan& plan, const MatrixXd& columns) {
  MatrixXd result;
  std::vector<VectorXd> all(static_cast<std::size_t>(columns.cols()));
  for_every_column(columns, [&](Index joint) {
    all[static_cast<std::size_t>(joint)] = filtered(plan, columns.col(joint));
  });
  for (std::size_t joint = 0; joint < all.size(); ++joint) {
    if (joint == 0) result.resize(all[joint].size(), columns.cols());
    result.col(static_cast<Index>(joint)) = all[joint];
  }
  return result;
}

// Of the measured torque, per joint.
VectorXd noise_densities(const Measurement& measured) {
  const Log& log = *measured.log;
  VectorXd densities(log.tau.cols());
  for (Index joint = 0; joint < densities.size(); ++joint) {
    const VectorXd raw = log.tau.col(joint);
    densities[joint] = noise_density(
        raw,
        zero_phase_low_pass(raw, measured.plan.position_cutoff_hz, measured.plan.sample_rate_hz),
        usable_samples(log, measured.plan, joint), measured.plan);
  }
  return densities;
}

void leave_out_faults(const Log& log, Measurement& measured) {
  measured.at_fault = VectorXd::Zero(measured.moving.cols());
  if (log.left_out.empty()) return;
  for (Index joint = 0; joint < measured.moving.cols(); ++joint) {
    const VectorXd kept = kept_samples(measured.plan, usable_samples(log, measured.plan, joint));
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

std::shared_ptr<const Log> held_elsewhere(const Log& log) {
  return {std::shared_ptr<const Log>(), &log};
}

Measurement measure(std::shared_ptr<const Log> held, const RobotDescription& robot,
                    const FilterPlan& plan) {
  const Log& log = *held;
  require_joints(log, robot);
  Measurement measured;
  measured.plan = plan_for(log, plan);
  measured.motion = motion_of(log, measured.plan);
  measured.t_s = kept_samples(measured.plan, log.t_s);
  measured.torque = filtered_columns(measured.plan, log.tau);
  if (log.sensor_tau.rows() > 0) {
    measured.sensor_torque = filtered_columns(measured.plan, log.sensor_tau);
  }
  measured.moving.resize(measured.t_s.size(), log.q.cols());
  for_every_column(log.q, [&](Index joint) {
    const VectorXd speed = measured.motion.dq.col(joint);
    measured.moving.col(joint) =
        kept_samples(measured.plan, samples_that_tell(log, robot, joint, speed));
  });
  leave_out_faults(log, measured);
  measured.log = std::move(held);
  return measured;
}

Measurement measure(Log log, const RobotDescription& robot, const FilterPlan& plan) {
  return measure(std::make_shared<const Log>(std::move(log)), robot, plan);
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
      seen_by_sensors(carrying(robot, measured.log->payload), *measured.log);
  // A model's torque is kept three times over: of so much it is made anew instead.
  constexpr Index kMostNumbers = 10'000'000;
  const bool is_kept = measured.motion.q.size() <= kMostNumbers;
  MatrixXd torque =
      is_kept ? model_torque(seen, measured.motion, bodies_) : model_torque(seen, measured.motion);
  if (has_transmission_effect(seen)) {
    torque += transmission_torque(seen, measured.motion, torque, measured.log->tau,
                                  noise_densities(measured), measured.plan);
  }
  if (!is_kept) return filtered_columns(measured.plan, torque);
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
