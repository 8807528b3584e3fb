#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "analysis/fit_problem.hpp"
#include "analysis/normal_equations.hpp"

namespace offnominal::tools {

// Half-widths of 95 % confidence intervals at a solution; none where a value was left at its start
// or the data do not determine it.
struct Intervals {
  std::vector<std::optional<double>> linear;  // per unknown, in its unit
  // Per shape group: in the logarithm of the value for logarithmic groups, else in its unit.
  std::vector<std::optional<double>> shape;
};

// Intervals that hold for correlated errors: the scores are summed per block of time before their
// spread is taken (cluster-robust covariance, K.-Y. Liang, S. L. Zeger, Biometrika 73(1), 1986), a
// block being 1 s or three correlation lengths of the residual, whichever is more; Student's t with
// as many degrees of freedom as there are blocks less unknowns. Linear and shape values vary
// jointly. All are none where the recording has too few blocks.
Intervals intervals_of(const FitProblem& problem, const LinearSolution& solution,
                       const std::vector<double>& shapes, const std::vector<double>& weights);

}  // namespace offnominal::tools
