#include "compare/measurement.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "compare/inverse_model.hpp"
#include "compare/standstill.hpp"
#include "log/seen_by_sensor.hpp"

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

}  // namespace

VectorXd Measurement::while_moving(const Eigen::Ref<const VectorXd>& values, Index joint) const {
  VectorXd kept(values.size());
  Index count = 0;
  for (Index i = 0; i < values.size(); ++i) {
    if (moving(i, joint) > 0) kept[count++] = values[i];
  }
  return kept.head(count);
}

Measurement measure(Log log, const RobotDescription& robot, const FilterPlan& plan) {
  if (log.joint_count() != robot.joint_count()) {
    throw InputError({log.file, "", fmt::format("{} joints", log.joint_count()),
                      fmt::format("{}, as the robot has", robot.joint_count()),
                      "give the robot file that belongs to this recording, or [channels]"});
  }
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
  measured.log = std::move(log);
  return measured;
}

Measurement measure(Log log, const RobotDescription& robot, const FilterRequest& request) {
  const FilterPlan plan = plan_filter({log}, robot, request);
  return measure(std::move(log), robot, plan);
}

MatrixXd filtered_model_torque(const RobotDescription& robot, const Measurement& measured) {
  return filtered_columns(measured.plan,
                          model_torque(seen_by_sensors(robot, measured.log), measured.motion));
}

}  // namespace offnominal::desk
