#pragma once

#include <Eigen/Core>
#include <vector>

namespace offnominal::desk::report {

/// A column as pages take numbers.
inline std::vector<double> numbers(const Eigen::Ref<const Eigen::VectorXd>& values) {
  return {values.data(), values.data() + values.size()};
}

}  // namespace offnominal::desk::report
