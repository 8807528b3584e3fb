#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/fit.hpp"
#include "inertial/pseudo_inertia.hpp"
#include "inertial/reduced_rows.hpp"

namespace offnominal::desk {

// What is fitted: links as bodies that there can be, and numbers that enter linearly.
struct ConsistentModel {
  struct Link {
    std::size_t link = 0;
    Eigen::Index first = 0;  // of its ten columns
    Eigen::Matrix4d about;   // upper factor of the body that is believed
    InertialNumbers start;   // that the columns are counted from
  };
  std::vector<Link> links;
  std::vector<Eigen::Index> linear;  // columns
  std::vector<Prior> priors;         // of the linear ones
  Eigen::Index columns = 0;
};

// A point of it.
struct ConsistentPoint {
  std::vector<LogCholesky> links;
  Eigen::VectorXd linear;
};

// Standard deviations of a link's ten coordinates where its mass and extent are believed within a
// share (1: to a factor of e or so).
LogCholesky deviations_of_share(double share);

ConsistentPoint start_of(const ConsistentModel& model);

// One factor per column.
Eigen::VectorXd columns_at(const ConsistentModel& model, const ConsistentPoint& point);

// The same linearised: columns of the regression to unknowns, links first, ten each.
Eigen::MatrixXd slopes_at(const ConsistentModel& model, const ConsistentPoint& point);
std::vector<Prior> priors_of(const ConsistentModel& model, double share);

// The point at which |equations|^2 and what is believed, prior_weight^2 |(x - mean) / deviation|^2,
// are least together, linear numbers within their ends. `from`: a point to start at.
ConsistentPoint consistent_fit(const ConsistentModel& model,
                               const ReducedRows::Equations& equations, double share,
                               double prior_weight, const ConsistentPoint& from);

}  // namespace offnominal::desk
