#pragma once

#include <vector>

#include "discovery/explain.hpp"
#include "discovery/regression.hpp"

namespace offnominal::tools::discovery {

// Parameters of every term of a fitted model with 95 % intervals: a covariance that is robust to
// errors correlated within a block of time (K.-Y. Liang, S. L. Zeger, Biometrika 73(1), 1986), the
// shapes linearised about where they are, Student's t with the blocks that tell of the joint
// concerned less the unknowns of that joint (analysis/freedom.hpp). Where these are too few, or the
// recordings do not determine a number, it says so.
std::vector<std::vector<Estimate>> estimates_of(const Regression& regression,
                                                const std::vector<Term>& terms,
                                                const ModelFit& fit);

}  // namespace offnominal::tools::discovery
