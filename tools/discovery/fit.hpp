#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace offnominal::tools::discovery {

// An unknown that the regression may move between two ends.
struct Box {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};

// Weighted least squares target = columns * x + error with every unknown in its box.
struct BoxedFit {
  Eigen::VectorXd x;
  std::vector<bool> at_bound;
  Eigen::VectorXd residual;  // weighted
  // Orthonormal basis of the columns that are free: what else is judged is judged beside them.
  Eigen::MatrixXd basis;
};

// `columns` and `target` are already weighted. Unknowns whose column adds nothing to those before
// it (relative 1e-9) stay at 0.
BoxedFit boxed_least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                             const std::vector<Box>& boxes);

}  // namespace offnominal::tools::discovery
