#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/estimates.hpp"

namespace offnominal::desk {

// Combinations of the unknowns of a linear model that was fitted beside the engine's regression,
// with the same intervals.
struct LinearModel {
  std::vector<Eigen::VectorXd> columns;  // stacked, not weighted
  std::vector<Prior> priors;             // one per column; held ones have no interval
};
struct Combination {
  double value = 0;
  Eigen::VectorXd of_unknowns;  // a factor per column
  Eigen::Index joint = 0;       // that tells of it
};

// `fit`: residual, joint_weights, prior_weight and remainder.blocks are read.
std::vector<Estimate> estimates_of(const Data& data, const ModelFit& fit, const LinearModel& model,
                                   const std::vector<Combination>& combinations);

}  // namespace offnominal::desk
