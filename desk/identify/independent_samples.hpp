#pragma once

#include <Eigen/Core>

#include "identify/rows.hpp"

namespace offnominal::desk {

// How many independent observations the residual of each joint is worth, by how it is correlated in
// time. `residual`: stacked.
Eigen::VectorXd independent_samples_of(const RowLayout& layout, const Eigen::VectorXd& residual);

// Length of a block of time between which the errors of a joint count as independent, s: three
// times as long as they are correlated, kShortestBlockS at least, and a twentieth of all recordings
// at most. `residual`: stacked.
double independent_block_s(const RowLayout& layout, const Eigen::VectorXd& residual,
                           Eigen::Index joint);

}  // namespace offnominal::desk
