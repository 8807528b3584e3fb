#pragma once

#include <Eigen/Core>
#include <vector>

#include "discovery/search.hpp"
#include "score.hpp"

namespace offnominal::bench {

// The columns of one candidate at one shape: weighted as the analysis does, and what the nuisance
// could do removed.
struct CandidateColumns {
  tools::discovery::EffectAt what;
  Eigen::MatrixXd columns;
};

// Every candidate at a few shapes of its grid: the ends and the middle; of a spectrum the largest
// peak of the residual's periodogram, since a few of its thousands of points would show nothing.
std::vector<CandidateColumns> candidate_columns(const tools::discovery::Search& search,
                                                const tools::discovery::ModelFit& nuisance_fit);

}  // namespace offnominal::bench
