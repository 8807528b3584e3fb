#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <offnominal/model/chain.hpp>
#include <offnominal/vector.hpp>

// Positions to which no joint comes within a tick. An encoder that jumps on a joint whose velocity
// is measured by itself shows nowhere else where the model's torque hardly depends on the position:
// a wrist's last joint, a vertical axis.

namespace offnominal {

// So many times as far as a joint at its largest velocity comes in a tick is farther than any: a
// sample that stood for one tick too long makes two of its ways, and time itself is measured too.
inline constexpr double kFartherThanAny = 3;

inline constexpr Eigen::Index kNoJoint = -1;

// The largest step of each joint that counted, rad or m; 0: none yet. Plain data.
template <int N, typename Scalar>
using LargestSteps = PerJoint<N, Scalar>;

// Takes the positions of two samples that are one tick of `period_s` apart: the first joint that
// cannot have gone from `before` to `now`, kNoJoint where all can. A joint without a largest
// velocity can have gone anywhere. A coarse encoder of a slow joint goes by counts that are farther
// apart than the joint comes: a step of at most twice the largest so far is none, and the first
// tells nothing.
template <int N, typename Scalar>
[[nodiscard]] Eigen::Index take_steps(const PerJoint<N, Joint<Scalar>>& joints,
                                      const Vector<N, Scalar>& before, const Vector<N, Scalar>& now,
                                      Scalar period_s, LargestSteps<N, Scalar>& largest) {
  Eigen::Index jumped = kNoJoint;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const Scalar step = Eigen::numext::abs(now[index] - before[index]);
    const Scalar farthest =
        static_cast<Scalar>(kFartherThanAny) * joints[i].max_velocity * period_s;
    const bool beyond = step > farthest && largest[i] > 0 && step > 2 * largest[i];
    if (beyond && jumped == kNoJoint) jumped = index;
    largest[i] = std::max(largest[i], step);
  }
  return jumped;
}

}  // namespace offnominal
