#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <offnominal/diagnosis/joint_bound.hpp>
#include <offnominal/diagnosis/position_step.hpp>
#include <offnominal/vector.hpp>

namespace offnominal {

// Whether the robot still behaves as its model says. `level` follows from tick to tick whether it
// is beyond: |e| > mu, or a position to which no motion comes (position_step.hpp);
// `latched` keeps the first crossing until clear_latch(), to be reported; `acts` that it came
// beyond the second level too (JointBound::act_ratio), where what is configured may be done. Where
// there is one level both are the same.
template <typename Scalar>
struct DetectorState {
  bool level = false;
  bool latched = false;
  bool acts = false;
  std::uint64_t detection_tick = 0;  // of the first crossing, from reset(); valid while latched
  double detection_time_s = 0;       // the same in seconds
};

// Takes what one tick was judged to be. At |e| = mu, and so at |e| = mu = 0, there is no detection.
template <typename Scalar>
inline void update(DetectorState<Scalar>& state, bool beyond, bool acts, std::uint64_t tick,
                   double time_s) {
  state.level = beyond;
  state.acts = state.acts || acts;
  if (state.level && !state.latched) {
    state.latched = true;
    state.detection_tick = tick;
    state.detection_time_s = time_s;
  }
}

// Of one level.
template <typename Scalar>
inline void update(DetectorState<Scalar>& state, bool beyond, std::uint64_t tick, double time_s) {
  update(state, beyond, beyond, tick, time_s);
}

// The same joint by joint. Its own level is that of any joint; its latch, of the first.
template <int N, typename Scalar>
struct JointDetectors : DetectorState<Scalar> {
  PerJoint<N, DetectorState<Scalar>> joints{};
  std::uint8_t first_joint = 0;  // that latched first, from 0; valid while latched
};

// A tick's errors and thresholds in one unit: of each joint those of the filter that is nearer to
// its threshold, or farther beyond.
template <int N, typename Scalar>
struct JointErrors {
  Vector<N, Scalar> size;       // |e_i| >= 0
  Vector<N, Scalar> threshold;  // mu_i >= 0
  PerJoint<N, bool> acts{};     // beyond the second level of any of its filters
};

// Of one filter, and with another beside it; `bounds` says where the second level is.
template <int N, typename Scalar>
[[nodiscard]] inline JointErrors<N, Scalar> errors_of(
    const Vector<N, Scalar>& e, const Vector<N, Scalar>& mu,
    const PerJoint<N, JointBound<Scalar>>& bounds) {
  JointErrors<N, Scalar> errors{e.cwiseAbs(), mu, {}};
  size_for(bounds.size(), errors.acts);
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    errors.acts[i] = errors.size[joint] > bounds[i].act_ratio * mu[joint];
  }
  return errors;
}
template <int N, typename Scalar>
inline void add(const JointErrors<N, Scalar>& other, JointErrors<N, Scalar>& errors) {
  for (std::size_t i = 0; i < errors.acts.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    errors.acts[i] = errors.acts[i] || other.acts[i];
    const bool nearer =
        other.size[joint] * errors.threshold[joint] > errors.size[joint] * other.threshold[joint];
    if (!nearer) continue;
    errors.size[joint] = other.size[joint];
    errors.threshold[joint] = other.threshold[joint];
  }
}

// Judges one tick: joint i by |e_i| > mu_i; `jumped`, which may be kNoJoint, is beyond both levels
// whatever its error. The joint with the largest |e_i| / mu_i; of several that cross first in the
// same tick it is the one that is said, but for one that jumped.
template <int N, typename Scalar>
inline Eigen::Index update(JointDetectors<N, Scalar>& state, const JointErrors<N, Scalar>& errors,
                           Eigen::Index jumped, std::uint64_t tick, double time_s) {
  const Vector<N, Scalar>& size = errors.size;
  const Vector<N, Scalar>& mu = errors.threshold;
  Eigen::Index worst = 0;
  bool any = false;
  bool any_acts = false;
  for (Eigen::Index i = 0; i < size.size(); ++i) {
    const auto index = static_cast<std::size_t>(i);
    DetectorState<Scalar>& joint = state.joints[index];
    const bool acts = errors.acts[index] || i == jumped;
    update(joint, size[i] > mu[i] || i == jumped, acts, tick, time_s);
    any = any || joint.level;
    any_acts = any_acts || acts;
    if (size[i] * mu[worst] > size[worst] * mu[i]) worst = i;
  }
  const bool first = any && !state.latched;
  if (first) state.first_joint = static_cast<std::uint8_t>(jumped == kNoJoint ? worst : jumped);
  update(static_cast<DetectorState<Scalar>&>(state), any, any_acts, tick, time_s);
  return worst;
}

// Of a load on the joints, N m or N, what somebody may act on: nothing before any joint is beyond
// the second level, and nothing on a joint that was noticed and is not. On the others a body that
// is carried acts too.
template <int N, typename Scalar>
[[nodiscard]] inline Vector<N, Scalar> acted_on(const Vector<N, Scalar>& load,
                                                const JointDetectors<N, Scalar>& state) {
  Vector<N, Scalar> acted = load;
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    const DetectorState<Scalar>& joint = state.joints[i];
    if (!state.acts || (joint.latched && !joint.acts)) acted[static_cast<Eigen::Index>(i)] = 0;
  }
  return acted;
}

// Forgets the latched detection. The next crossing latches again, with its own time.
template <typename Scalar>
inline void clear_latch(DetectorState<Scalar>& state) {
  state.latched = false;
  state.acts = false;
  state.detection_tick = 0;
  state.detection_time_s = 0;
}
template <int N, typename Scalar>
inline void clear_latch(JointDetectors<N, Scalar>& state) {
  clear_latch(static_cast<DetectorState<Scalar>&>(state));
  for (DetectorState<Scalar>& joint : state.joints) clear_latch(joint);
}

}  // namespace offnominal
