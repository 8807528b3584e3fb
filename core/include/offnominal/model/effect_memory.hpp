#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/model/chain.hpp>
#include <offnominal/model/rigid_body_model.hpp>
#include <offnominal/sample.hpp>
#include <offnominal/status.hpp>

// What a model's effects with a memory (effects/memory.hpp) carry from one sample to the next. The
// dynamics themselves stay a function of one instant: they are given the torque that is left once
// the late drive and the remembered torque are taken into account.
//
// Monitor takes one of two policies: WithMemory, or WithoutMemory (the default), which costs
// nothing and refuses a chain with such an effect.

namespace offnominal {

// The longest delay of a drive, in ticks.
inline constexpr int kMaxDelayTicks = 128;

namespace detail {

template <typename E>
inline constexpr bool kHasState = action_of<E>() == EffectAction::kTorqueOfState;
template <typename E>
inline constexpr bool kHasDelay = action_of<E>() == EffectAction::kDelay;

}  // namespace detail

// Whether an effect of this kind has a memory.
[[nodiscard]] constexpr bool remembers(EffectKind kind) {
  bool found = false;
  visit_effect(kind, [&]<typename E>() { found = detail::kHasState<E> || detail::kHasDelay<E>; });
  return found;
}

// How much later than it is logged the torque of a joint acts, s, >= 0: all its delays together.
template <int N, typename Scalar>
[[nodiscard]] constexpr Scalar delay_of_joint(const Chain<N, Scalar>& chain, std::size_t joint) {
  Scalar delay_s{};
  for (const Effect<Scalar>& effect : chain.effects.view()) {
    if (effect.joint != joint) continue;
    visit_effect(effect.kind, [&]<typename E>() {
      if constexpr (detail::kHasDelay<E>) delay_s += E::delay_s(effect.parameters);
    });
  }
  return delay_s;
}

template <int N, typename Scalar>
class NoEffectMemory {
 public:
  // What acts at a sample: the logged torque itself.
  struct Now {
    [[nodiscard]] const Vector<N, Scalar>& acting(const Vector<N, Scalar>& tau) const {
      return tau;
    }
    [[nodiscard]] const Vector<N, Scalar>& driving(const Vector<N, Scalar>& tau) const {
      return tau;
    }
  };
  using State = Now;

  // kNeedsMemory where the chain has an effect with a memory.
  [[nodiscard]] static Status validate(const Chain<N, Scalar>& chain, Scalar /*period_s*/) {
    for (const Effect<Scalar>& effect : chain.effects.view()) {
      if (remembers(effect.kind)) return Status::kNeedsMemory;
    }
    return Status::kOk;
  }
  void prepare(const Chain<N, Scalar>& /*chain*/, const RigidBodyModel<N, Scalar>& /*model*/,
               Scalar /*period_s*/) {}
  [[nodiscard]] Now begin(const JointSample<N, Scalar>& /*sample*/) const { return {}; }
  [[nodiscard]] Now next(const JointSample<N, Scalar>& /*sample*/, std::uint32_t /*missed*/,
                         const State& /*state*/) const {
    return {};
  }
  void keep_begin(const JointSample<N, Scalar>& /*sample*/, const Now& /*now*/,
                  State& /*state*/) const {}
  void keep(const JointSample<N, Scalar>& /*sample*/, std::uint32_t /*missed*/, const Now& /*now*/,
            State& /*state*/) const {}
};

// Use: begin() or next() says what acts at a sample and changes nothing; once the sample has been
// accepted, keep_begin() or keep() takes it into the state.
template <int N, typename Scalar>
class EffectMemory {
 public:
  static constexpr int kCapacity = kEffectsPerJoint * kMostJoints<N>;

  // What acts at a sample, N m or N per joint.
  struct Now {
    Vector<N, Scalar> tau = zeros<N, Scalar>();  // logged torque that arrives now
    // What effects with a state take of it, as the drive has to be told.
    Vector<N, Scalar> remembered = zeros<N, Scalar>();
    std::array<Scalar, static_cast<std::size_t>(kCapacity)> z{};  // per effect with a state

    [[nodiscard]] const Vector<N, Scalar>& acting(const Vector<N, Scalar>& /*tau*/) const {
      return tau;
    }
    // What is left for the dynamics of a torque that acts now.
    [[nodiscard]] Vector<N, Scalar> driving(const Vector<N, Scalar>& acts) const {
      return acts - remembered;
    }
  };
  struct State : Now {
    Vector<N, Scalar> q = zeros<N, Scalar>();  // at the last sample
    // Logged torques, the newest at `newest`, older ones before it, round and round.
    std::array<Vector<N, Scalar>, static_cast<std::size_t>(kMaxDelayTicks) + 2> logged{};
    std::uint8_t newest = 0;
  };

  // kInvalidEffect where a joint's torque is later than kMaxDelayTicks.
  [[nodiscard]] static Status validate(const Chain<N, Scalar>& chain, Scalar period_s) {
    for (std::size_t joint = 0; joint < chain.joints.size(); ++joint) {
      const bool possible = delay_of_joint(chain, joint) <= kMaxDelayTicks * period_s;
      if (!possible) return Status::kInvalidEffect;
    }
    return Status::kOk;
  }
  // Of a chain that validate() accepts, and its model.
  void prepare(const Chain<N, Scalar>& chain, const RigidBodyModel<N, Scalar>& model,
               Scalar period_s) {
    with_state_ = {};
    for (const Effect<Scalar>& effect : chain.effects.view()) {
      visit_effect(effect.kind, [&]<typename E>() {
        if constexpr (detail::kHasState<E>) static_cast<void>(with_state_.add(effect));
      });
    }
    told_per_given_ = model.told_per_given;
    size_for(chain.joints.size(), whole_ticks_, part_of_tick_);
    for (std::size_t joint = 0; joint < chain.joints.size(); ++joint) {
      const Scalar ticks = delay_of_joint(chain, joint) / period_s;
      whole_ticks_[joint] = static_cast<std::uint8_t>(ticks);
      part_of_tick_[joint] = ticks - static_cast<Scalar>(whole_ticks_[joint]);
    }
  }

  // At the first sample of a run.
  [[nodiscard]] Now begin(const JointSample<N, Scalar>& sample) const {
    Now now;
    size_for(whole_ticks_.size(), now.remembered);
    now.tau = sample.tau;
    return now;
  }
  // At a sample before which `missed` ticks had none: the way to it is taken for one without a
  // reversal, and its torque for theirs.
  [[nodiscard]] Now next(const JointSample<N, Scalar>& sample, std::uint32_t missed,
                         const State& state) const {
    Now now;
    size_for(whole_ticks_.size(), now.tau, now.remembered);
    std::size_t i = 0;
    for (const Effect<Scalar>& effect : with_state_.view()) {
      const auto joint = static_cast<Eigen::Index>(effect.joint);
      visit_effect(effect.kind, [&]<typename E>() {
        if constexpr (detail::kHasState<E>) {
          now.z[i] = E::next_state(effect.parameters, state.z[i], sample.q[joint] - state.q[joint]);
          now.remembered[joint] +=
              told_per_given_[joint] * E::torque_of_state(effect.parameters, now.z[i]);
        }
      });
      ++i;
    }
    for (std::size_t joint = 0; joint < whole_ticks_.size(); ++joint) {
      const std::uint32_t whole = whole_ticks_[joint];
      const Scalar later = logged(sample, missed, state, whole, joint);
      const Scalar earlier = logged(sample, missed, state, whole + 1, joint);
      now.tau[static_cast<Eigen::Index>(joint)] = later + part_of_tick_[joint] * (earlier - later);
    }
    return now;
  }

  void keep_begin(const JointSample<N, Scalar>& sample, const Now& now, State& state) const {
    state.logged.fill(sample.tau);
    state.newest = 0;
    keep_now(sample, now, state);
  }
  void keep(const JointSample<N, Scalar>& sample, std::uint32_t missed, const Now& now,
            State& state) const {
    const auto places = static_cast<std::uint32_t>(state.logged.size());
    const std::uint32_t ticks = std::min(missed, places - 1) + 1;
    for (std::uint32_t tick = 0; tick < ticks; ++tick) {
      state.newest = static_cast<std::uint8_t>((state.newest + 1U) % places);
      state.logged[state.newest] = sample.tau;
    }
    keep_now(sample, now, state);
  }

 private:
  // The torque that was logged `ticks` ticks before the sample.
  static Scalar logged(const JointSample<N, Scalar>& sample, std::uint32_t missed,
                       const State& state, std::uint32_t ticks, std::size_t joint) {
    const auto i = static_cast<Eigen::Index>(joint);
    if (ticks <= missed) return sample.tau[i];
    const auto places = static_cast<std::uint32_t>(state.logged.size());
    return state.logged[(state.newest + places - (ticks - missed - 1)) % places][i];
  }
  static void keep_now(const JointSample<N, Scalar>& sample, const Now& now, State& state) {
    static_cast<Now&>(state) = now;
    state.q = sample.q;
  }

  EffectList<Scalar, kCapacity> with_state_{};
  Vector<N, Scalar> told_per_given_ = ones<N, Scalar>();
  // Per joint: the delay in ticks.
  PerJoint<N, std::uint8_t> whole_ticks_{};
  PerJoint<N, Scalar> part_of_tick_{};
};

// Policies.
struct WithoutMemory {
  template <int N, typename Scalar>
  using Of = NoEffectMemory<N, Scalar>;
};
struct WithMemory {
  template <int N, typename Scalar>
  using Of = EffectMemory<N, Scalar>;
};

}  // namespace offnominal
