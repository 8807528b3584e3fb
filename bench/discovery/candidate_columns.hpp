#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/data.hpp"
#include "score.hpp"

namespace offnominal::bench {

// What the nuisance alone leaves of the torque, as the analysis weighs it.
struct NuisanceFit {
  Eigen::VectorXd joint_weights;
  Eigen::VectorXd residual;  // weighted
  Eigen::MatrixXd basis;     // orthonormal, of the weighted nuisance columns that are free
};
NuisanceFit fit_nuisance(const desk::Data& data);

// The columns of one candidate at one shape: weighted, and what the nuisance could do removed.
struct CandidateColumns {
  desk::EffectAt what;
  Eigen::MatrixXd columns;
};

// Every candidate at a few shapes of its grid: the ends and the middle; of a spectrum the largest
// peak of the residual's periodogram, since a few of its thousands of points would show nothing.
std::vector<CandidateColumns> candidate_columns(const desk::Data& data, const NuisanceFit& fit);

}  // namespace offnominal::bench
