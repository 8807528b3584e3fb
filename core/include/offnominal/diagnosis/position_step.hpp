#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <offnominal/model/chain.hpp>
#include <offnominal/vector.hpp>

// Positions to which no joint comes within a tick. An encoder that jumps on a joint whose velocity
// is measured by itself shows nowhere else where the model's torque hardly depends on the position:
// a wrist's last joint, a vertical axis.

namespace offnominal {

// So many times as far as a joint at its largest velocity comes in a tick, or as it ever came, is
// farther than any: a sample that stood for one tick too long makes two of its ways, and time
// itself is measured too.
inline constexpr double kFartherThanAny = 3;
// Steps other than 0 from which on the largest is known: a sensor's noise, or the counts of a
// coarse encoder, are wider than a slow joint's way.
inline constexpr std::uint8_t kStepsKnown = 100;

inline constexpr Eigen::Index kNoJoint = -1;

// What is known of a joint's steps from one tick to the next. Plain data.
template <typename Scalar>
struct KnownSteps {
  Scalar largest{};        // that was none, rad or m
  std::uint8_t moved = 0;  // number of those other than 0, up to kStepsKnown
};

// Takes the positions of two samples that are one tick of `period_s` apart: the first joint that
// cannot have gone from `before` to `now`, kNoJoint where all can. Of a joint without a largest
// velocity, or that has hardly moved yet, nothing is known.
template <int N, typename Scalar>
[[nodiscard]] Eigen::Index take_steps(const PerJoint<N, Joint<Scalar>>& joints,
                                      const Vector<N, Scalar>& before, const Vector<N, Scalar>& now,
                                      Scalar period_s, PerJoint<N, KnownSteps<Scalar>>& known) {
  constexpr auto kFarther = static_cast<Scalar>(kFartherThanAny);
  Eigen::Index jumped = kNoJoint;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    const Scalar step = Eigen::numext::abs(now[index] - before[index]);
    const Scalar farthest =
        std::max(kFarther * period_s * joints[i].max_velocity, kFarther * known[i].largest);
    if (step > farthest && known[i].moved >= kStepsKnown) {
      if (jumped == kNoJoint) jumped = index;
      continue;
    }
    known[i].largest = std::max(known[i].largest, step);
    if (step > 0 && known[i].moved < kStepsKnown) ++known[i].moved;
  }
  return jumped;
}

}  // namespace offnominal
