#pragma once

#include <cstdint>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <offnominal/exponential.hpp>
#include <offnominal/status.hpp>

// Position, velocity and torque of one time, of a joint whose encoder sends positions alone.
//
// An observed velocity is late: beside position and torque of now, an acceleration of a makes an
// error of 2 a / bandwidth of it, which looks like a fault for as long as the joint accelerates. It
// is, to the last digit, the mean over the last tick of the velocity of the position that has gone
// twice through the low-pass (1 - a) / (1 - a / z), a = exp(-bandwidth period). Torque and position
// that go through the same two belong to it: linear equations of motion hold for what is filtered
// alike, and the arm's own do but for what its inertia and gravity change within 2 / bandwidth, to
// second order. What is left is the encoder's noise, and that all is seen so much later.

namespace offnominal {

template <typename Scalar>
struct ObservedMotionState {
  VelocityObserverState<Scalar> observer;
  // Torque behind one low-pass and behind both, N m or N.
  Scalar torque_once{};
  Scalar torque_twice{};
};

// Of one joint, at the middle of a tick 2 / bandwidth ago.
template <typename Scalar>
struct ObservedMotion {
  Scalar position{};  // rad or m
  Scalar velocity{};  // rad/s or m/s: the observer's own
  Scalar torque{};    // N m or N
};

// One tick, as update() of the observer, and with its errors; the state is then unchanged. `torque`
// as it was during the tick, N m or N, taken for that of the missed ones too. Where the observer
// starts, so does the torque.
template <typename Scalar>
[[nodiscard]] Status observe(const VelocityObserverConfig<Scalar>& config, Scalar position,
                             Scalar torque, std::uint32_t missed,
                             ObservedMotionState<Scalar>& state, ObservedMotion<Scalar>& motion) {
  const Status status = update(config, position, state.observer, missed);
  if (status != Status::kOk) return status;
  if (state.observer.updates == 1) state.torque_once = state.torque_twice = torque;
  const Scalar pole = exponential(-config.bandwidth_rad_s * config.period_s);
  Scalar before = state.torque_twice;
  // No more than the observer bridges.
  for (std::uint32_t tick = 0; tick <= missed && state.observer.updates > 1; ++tick) {
    before = state.torque_twice;
    state.torque_once = torque + pole * (state.torque_once - torque);
    state.torque_twice = state.torque_once + pole * (state.torque_twice - state.torque_once);
  }
  // How far the mean over the last tick of what is behind both low-passes is behind the observer's
  // position.
  const Scalar ticks = 2 * pole / (1 - pole) + Scalar(0.5);
  motion.velocity = state.observer.velocity;
  motion.position = state.observer.position - ticks * config.period_s * motion.velocity;
  motion.torque = (before + state.torque_twice) / 2;
  return Status::kOk;
}

}  // namespace offnominal
