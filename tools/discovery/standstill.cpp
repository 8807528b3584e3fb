#include "discovery/standstill.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::tools::discovery {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd moving_samples(const Log& log, Index joint, double counts_per_unit) {
  constexpr double kCounts = 2;  // that a position flickers by
  constexpr double kSlack = 1e-6;
  constexpr double kFewest = 0.1;  // of all samples
  VectorXd moving = VectorXd::Ones(log.sample_count());
  if (log.at_rest || !(counts_per_unit > 0)) return moving;
  const double flicker = (kCounts + kSlack) / counts_per_unit;
  const auto shortest = static_cast<Index>(std::ceil(kStandstillS * log.sample_rate_hz()));
  const auto q = log.q.col(joint);
  for (Index first = 0; first < q.size();) {
    double low = q[first];
    double high = q[first];
    Index last = first;
    while (last + 1 < q.size() &&
           std::max(high, q[last + 1]) - std::min(low, q[last + 1]) <= flicker) {
      ++last;
      low = std::min(low, q[last]);
      high = std::max(high, q[last]);
    }
    if (last - first < shortest) {
      ++first;
      continue;
    }
    moving.segment(first, last + 1 - first).setZero();
    first = last + 1;
  }
  return moving.mean() < kFewest ? VectorXd::Ones(moving.size()).eval() : moving;
}

}  // namespace offnominal::tools::discovery
