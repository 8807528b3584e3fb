#include "analysis/measurement.hpp"

#include "analysis/inverse_model.hpp"

namespace offnominal::tools {
namespace {

Eigen::MatrixXd filtered_columns(const FilterPlan& plan, const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd result;
  for (Eigen::Index joint = 0; joint < columns.cols(); ++joint) {
    const Eigen::VectorXd column = filtered(plan, columns.col(joint));
    if (joint == 0) result.resize(column.size(), columns.cols());
    result.col(joint) = column;
  }
  return result;
}

}  // namespace

Measurement measure(Log log, const FilterRequest& request) {
  Measurement measured;
  measured.plan = plan_filter(log, request);
  measured.motion = motion_of(log, measured.plan);
  measured.t_s = kept_samples(measured.plan, log.t_s);
  measured.torque = filtered_columns(measured.plan, log.tau);
  measured.log = std::move(log);
  return measured;
}

Eigen::MatrixXd filtered_model_torque(const RobotDescription& robot, const Measurement& measured) {
  return filtered_columns(measured.plan, model_torque(robot, measured.motion));
}

}  // namespace offnominal::tools
