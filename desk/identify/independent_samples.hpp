#pragma once

#include <Eigen/Core>

#include "identify/rows.hpp"

namespace offnominal::desk {

// How many independent observations the residual of each joint is worth, by how it is correlated in
// time. `residual`: stacked.
Eigen::VectorXd independent_samples_of(const RowLayout& layout, const Eigen::VectorXd& residual);

}  // namespace offnominal::desk
