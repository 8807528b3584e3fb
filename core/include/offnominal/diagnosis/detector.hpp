#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/position_step.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

// Whether the robot still behaves as its model says. `level` follows from tick to tick whether it
// is beyond: |e| > mu, or a position to which no motion comes (position_step.hpp);
// `latched` keeps the first crossing until clear_latch().
template <typename Scalar>
struct DetectorState {
  bool level = false;
  bool latched = false;
  std::uint64_t detection_tick = 0;  // of the first crossing, from reset(); valid while latched
  double detection_time_s = 0;       // the same in seconds
};

// Takes what one tick was judged to be. At |e| = mu, and so at |e| = mu = 0, there is no detection.
template <typename Scalar>
inline void update(DetectorState<Scalar>& state, bool beyond, std::uint64_t tick, double time_s) {
  state.level = beyond;
  if (state.level && !state.latched) {
    state.latched = true;
    state.detection_tick = tick;
    state.detection_time_s = time_s;
  }
}

// The same joint by joint. Its own level is that of any joint; its latch, of the first.
template <int N, typename Scalar>
struct JointDetectors : DetectorState<Scalar> {
  PerJoint<N, DetectorState<Scalar>> joints{};
  std::uint8_t first_joint = 0;  // that latched first, from 0; valid while latched
};

// Judges one tick: joint i by |e_i| > mu_i >= 0, in the same unit; `jumped`, which may be kNoJoint,
// is beyond whatever its error. The joint with the largest |e_i| / mu_i; of several that cross
// first in the same tick it is the one that is said, but for one that jumped.
template <int N, typename Scalar>
inline Eigen::Index update(JointDetectors<N, Scalar>& state, const Vector<N, Scalar>& e,
                           const Vector<N, Scalar>& mu, Eigen::Index jumped, std::uint64_t tick,
                           double time_s) {
  Eigen::Index worst = 0;
  bool any = false;
  for (Eigen::Index i = 0; i < e.size(); ++i) {
    const Scalar size = Eigen::numext::abs(e[i]);
    DetectorState<Scalar>& joint = state.joints[static_cast<std::size_t>(i)];
    update(joint, size > mu[i] || i == jumped, tick, time_s);
    any = any || joint.level;
    if (size * mu[worst] > Eigen::numext::abs(e[worst]) * mu[i]) worst = i;
  }
  const bool first = any && !state.latched;
  if (first) state.first_joint = static_cast<std::uint8_t>(jumped == kNoJoint ? worst : jumped);
  update(static_cast<DetectorState<Scalar>&>(state), any, tick, time_s);
  return worst;
}

// Forgets the latched detection. The next crossing latches again, with its own time.
template <typename Scalar>
inline void clear_latch(DetectorState<Scalar>& state) {
  state.latched = false;
  state.detection_tick = 0;
  state.detection_time_s = 0;
}
template <int N, typename Scalar>
inline void clear_latch(JointDetectors<N, Scalar>& state) {
  clear_latch(static_cast<DetectorState<Scalar>&>(state));
  for (DetectorState<Scalar>& joint : state.joints) clear_latch(joint);
}

}  // namespace offnominal
