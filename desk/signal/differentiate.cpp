#include "signal/differentiate.hpp"

#include <stdexcept>

namespace offnominal::desk {

Eigen::VectorXd central_difference(const Eigen::Ref<const Eigen::VectorXd>& signal,
                                   double period_s) {
  const Eigen::Index n = signal.size();
  if (n < 3) throw std::invalid_argument("a signal to differentiate has at least 3 samples");
  if (!(period_s > 0)) throw std::invalid_argument("the sampling period must be greater than 0 s");
  Eigen::VectorXd derivative(n);
  derivative.segment(1, n - 2) = (signal.tail(n - 2) - signal.head(n - 2)) / (2 * period_s);
  derivative[0] = (-3 * signal[0] + 4 * signal[1] - signal[2]) / (2 * period_s);
  derivative[n - 1] = (3 * signal[n - 1] - 4 * signal[n - 2] + signal[n - 3]) / (2 * period_s);
  return derivative;
}

}  // namespace offnominal::desk
