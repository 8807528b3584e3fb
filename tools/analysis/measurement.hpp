#pragma once

#include <Eigen/Core>

#include "analysis/filter_plan.hpp"
#include "analysis/motion.hpp"
#include "log/log.hpp"
#include "robot/robot.hpp"

namespace offnominal::tools {

// A recording made ready for comparison and regression: everything that does not depend on the
// model is filtered once.
struct Measurement {
  Log log;
  FilterPlan plan;
  Motion motion;           // full rate
  Eigen::VectorXd t_s;     // of the samples that are kept
  Eigen::MatrixXd torque;  // filtered; rows: kept samples, columns: joints
};

// Throws InputError as plan_filter().
Measurement measure(Log log, const FilterRequest& request);

// model_torque() of a robot, filtered as the measured torque is.
Eigen::MatrixXd filtered_model_torque(const RobotDescription& robot, const Measurement& measured);

}  // namespace offnominal::tools
