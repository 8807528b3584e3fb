#pragma once

#include <Eigen/Core>
#include <cmath>

namespace offnominal::desk {

/// Size of a joint's residual and its threshold, N m or N.
struct ResidualAgainst {
  double residual = 0;
  double threshold = 0;
  bool fast = false;  // of the fast filter
};

/// Of a joint behind two filters those of the one that is nearer to its threshold, or farther
/// beyond; `fast_error` and `fast_thresholds` empty: there is one filter.
template <typename Values>
[[nodiscard]] ResidualAgainst nearer_filter(const Values& error, const Values& thresholds,
                                            const Values& fast_error, const Values& fast_thresholds,
                                            Eigen::Index joint) {
  const ResidualAgainst slow{std::abs(error[joint]), thresholds[joint]};
  if (fast_error.size() == 0) return slow;
  const ResidualAgainst fast{std::abs(fast_error[joint]), fast_thresholds[joint], true};
  return fast.residual * slow.threshold > slow.residual * fast.threshold ? fast : slow;
}

}  // namespace offnominal::desk
