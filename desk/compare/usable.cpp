#include "compare/usable.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::desk {

using Eigen::Index;
using Eigen::VectorXd;

VectorXd usable_samples(const Log& log, const FilterPlan& plan, Index joint) {
  if (log.left_out.empty()) return {};
  const Index rows = log.sample_count();
  VectorXd usable = VectorXd::Ones(rows);
  for (const LeftOut& out : log.left_out) {
    if (out.joint != joint) continue;
    const auto spread = static_cast<Index>(
        std::ceil(out.spread_periods * plan.sample_rate_hz / plan.torque_cutoff_hz));
    const Index first = std::clamp<Index>(out.rows.first - spread, 0, rows);
    const Index end = std::clamp<Index>(out.rows.last + 1 + spread, first, rows);
    usable.segment(first, end - first).setZero();
  }
  return usable;
}

}  // namespace offnominal::desk
