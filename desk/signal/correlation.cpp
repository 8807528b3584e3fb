#include "signal/correlation.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

double correlation_samples(const Eigen::Ref<const VectorXd>& signal) {
  constexpr double kNegligible = 0.05;
  const Index n = signal.size();
  const VectorXd centred = signal.array() - signal.mean();
  const double energy = centred.squaredNorm();
  if (!(energy > 0)) return 1;
  double sum = 1;
  for (Index lag = 1; lag < n / 2; ++lag) {
    const double correlation = centred.head(n - lag).dot(centred.tail(n - lag)) / energy;
    if (correlation < kNegligible) break;
    sum += 2 * correlation;
  }
  return sum;
}

}  // namespace offnominal::desk
