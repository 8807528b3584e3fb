#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace offnominal::tools::discovery {

// What is believed of an unknown before the regression: about its mean with this standard deviation
// (infinite: nothing), and never outside of the two ends.
struct Prior {
  double mean = 0;
  double deviation = std::numeric_limits<double>::infinity();
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  [[nodiscard]] bool is_informative() const {
    return deviation < std::numeric_limits<double>::infinity();
  }
};

// Weighted least squares target = columns * x + error beside what is believed of x.
struct PriorFit {
  Eigen::VectorXd x;
  // Weighted; behind the rows of the target one row per informative prior: prior_weight times how
  // far the unknown is below its mean, in standard deviations.
  Eigen::VectorXd residual;
  // Orthonormal basis of the columns that are free, with the same rows: what else is judged is
  // judged beside them.
  Eigen::MatrixXd basis;
};

// `columns` and `target` are already weighted to errors of size 1. `prior_weight` is the root of
// the number of rows that count as one independent observation: a prior is one. Unknowns whose
// column adds nothing to those before it (relative 1e-7) stay at 0.
PriorFit least_squares_with_priors(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                   const std::vector<Prior>& priors, double prior_weight);

}  // namespace offnominal::tools::discovery
