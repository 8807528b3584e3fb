#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// The value that `share` (0 to 1) of the values do not exceed, without interpolation. There must be
// at least one value.
double quantile(Eigen::VectorXd values, double share);

}  // namespace offnominal::desk
