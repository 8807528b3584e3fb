#pragma once

#include <Eigen/Core>
#include <vector>

#include "discovery/search.hpp"

namespace offnominal::tools::discovery {

// Residual of a fitted model on other recordings of the same robot, stacked.
Eigen::VectorXd residual_on(const Data& other, const std::vector<Term>& terms, const ModelFit& fit);

// Residual of every part of the recordings by a fit of the other parts: contiguous blocks of time,
// never single rows. Shapes stay as the whole recording gave them.
Eigen::VectorXd cross_validated_residual(const Search& search, const std::vector<Term>& terms);

}  // namespace offnominal::tools::discovery
