#include "signal/quantile.hpp"

#include <algorithm>

namespace offnominal::desk {

double quantile(Eigen::VectorXd values, double share) {
  const auto rank = static_cast<Eigen::Index>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.data(), values.data() + rank, values.data() + values.size());
  return values[rank];
}

}  // namespace offnominal::desk
