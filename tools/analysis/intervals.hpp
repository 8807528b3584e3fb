#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/fit_problem.hpp"
#include "analysis/normal_equations.hpp"

namespace offnominal::tools {

// Half-width of a 95 % confidence interval; where there is none, why, in words.
struct HalfWidth {
  std::optional<double> value;
  std::string why_none = {};
};

struct Intervals {
  std::vector<HalfWidth> linear;  // per unknown, in its unit
  // Per shape group: in the logarithm of the value for logarithmic groups, else in its unit.
  std::vector<HalfWidth> shape;
};

// Intervals that hold for correlated errors: the scores are summed per block of time before their
// spread is taken (cluster-robust covariance, K.-Y. Liang, S. L. Zeger, Biometrika 73(1), 1986), a
// block being 1 s or three correlation lengths of the residual, whichever is more; Student's t with
// as many degrees of freedom as there are blocks less unknowns of the joint concerned
// (freedom.hpp). Linear and shape values vary jointly.
Intervals intervals_of(const FitProblem& problem, const LinearSolution& solution,
                       const std::vector<double>& shapes, const std::vector<double>& weights);

}  // namespace offnominal::tools
