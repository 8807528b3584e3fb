#pragma once

#include <Eigen/Core>

#include "analysis/filter_plan.hpp"
#include "log/log.hpp"

namespace offnominal::tools {

// The motion of a recording at its full sampling rate. Rows: samples, columns: joints.
struct Motion {
  Eigen::VectorXd t_s;  // as recorded
  Eigen::MatrixXd q;    // low-passed position, rad or m
  Eigen::MatrixXd dq;   // central differences of q
  Eigen::MatrixXd ddq;  // central differences of dq

  [[nodiscard]] Eigen::Index sample_count() const { return t_s.size(); }
};

// Velocity and acceleration both come from the low-passed position, whatever velocity the log has:
// then all three belong together, and none of them lags. Of a hold map: its positions, at rest.
Motion motion_of(const Log& log, const FilterPlan& plan);

}  // namespace offnominal::tools
