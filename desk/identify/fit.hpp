#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace offnominal::desk {

// What is believed of an unknown before the regression: about its mean with this standard deviation
// (infinite: nothing), and never outside of the two ends.
struct Prior {
  double mean = 0;
  double deviation = std::numeric_limits<double>::infinity();
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();

  // Held there, but for rounding.
  static Prior at(double value) {
    const double wide = rounding_of(value);
    return {value, std::numeric_limits<double>::infinity(), value - wide, value + wide};
  }
  static double rounding_of(double value) { return 1e-9 * (value < 0 ? -value : value) + 1e-12; }
  // Whether its ends are apart by no more than at() has them: then it is the middle that is meant.
  [[nodiscard]] bool is_one_value() const {
    constexpr double kOfRounding = 2.1;
    return high - low < std::numeric_limits<double>::infinity() &&
           high - low <= kOfRounding * rounding_of((low + high) / 2);
  }

  [[nodiscard]] bool is_informative() const {
    return deviation < std::numeric_limits<double>::infinity();
  }
  // Nothing is believed, and nothing is free: as at() has it.
  [[nodiscard]] bool is_held() const {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    return !is_informative() && low > -kNone && high < kNone;
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
  // The columns, with the rows of the priors, times this are the basis.
  Eigen::MatrixXd to_basis;
};

// What a prior weighs in the regression: one row with this in the column of its unknown.
inline double row_of(const Prior& prior, double prior_weight) {
  return prior_weight / prior.deviation;
}

// `columns` and `target` are already weighted to errors of size 1. `prior_weight` is the root of
// the number of rows that count as one independent observation: a prior is one. Unknowns whose
// column adds nothing to those before it (relative 1e-7) stay at 0. One that has but one value has
// exactly that.
PriorFit least_squares_with_priors(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
                                   const std::vector<Prior>& priors, double prior_weight);

// How well the same regression fits with more columns beside its own, for many of them: what is its
// own is turned once. Its unknowns are free within their ends, which a basis of the free ones alone
// does not know.
class ProfileFit {
 public:
  ProfileFit(const Eigen::MatrixXd& columns, const Eigen::VectorXd& target,
             std::vector<Prior> priors, double prior_weight);

  // Energy that is left, rows of the priors included, with these columns, weighted as the others.
  [[nodiscard]] double energy_with(const Eigen::MatrixXd& more) const;
  // Their unknowns.
  [[nodiscard]] Eigen::VectorXd unknowns_of(const Eigen::MatrixXd& more) const;

 private:
  struct Whole {
    PriorFit fit;
    double energy_beside;  // that no column reaches
  };
  [[nodiscard]] Whole fitted_with(const Eigen::MatrixXd& more) const;

  Eigen::MatrixXd basis_;   // orthonormal
  Eigen::MatrixXd upper_;   // columns = basis * upper
  Eigen::VectorXd along_;   // of the target, in the basis
  Eigen::VectorXd beside_;  // the target less that
  std::vector<Prior> priors_;
  double prior_weight_;
};

}  // namespace offnominal::desk
