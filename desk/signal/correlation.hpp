#pragma once

#include <Eigen/Core>

namespace offnominal::desk {

// How many samples of a correlated signal carry as much as one independent sample: 1 + 2 sum of its
// autocorrelation up to where that first falls below 0.05. At least 1.
double correlation_samples(const Eigen::Ref<const Eigen::VectorXd>& signal);

}  // namespace offnominal::desk
