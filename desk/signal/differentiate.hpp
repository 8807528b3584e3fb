#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// Derivative of evenly spaced samples: (x[k+1] - x[k-1]) / (2 period), one-sided differences of
// second order at both ends. Of sin(w t) it is off by the factor sin(w period) / (w period).
// Throws std::invalid_argument when there are fewer than 3 samples or period_s <= 0.
Eigen::VectorXd central_difference(const Eigen::Ref<const Eigen::VectorXd>& signal,
                                   double period_s);

}  // namespace offnominal::desk
