#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/control/arming.hpp>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/control/reference_ramp.hpp>
#include <offnominal/controller/arming_check.hpp>
#include <offnominal/controller/controller_config.hpp>
#include <offnominal/controller/fault.hpp>
#include <offnominal/sample.hpp>

// From arming until a controller has the arm: brakes open, drives come, the torque rises by its
// rate. Time stands meanwhile and nothing is watched, as nobody knows which torque acts; so it has
// an end, and the arm has to stay where it was.

namespace offnominal::controller {

// Plain data.
template <int N, typename Scalar>
struct TakeoverData {
  std::uint64_t waiting_ticks = 0;  // from arming until time began
  // Since arming there was a sample to begin with: where the joints were in it and how fast, rad or
  // m, rad/s or m/s, and when.
  bool holds = false;
  Vector<N, Scalar> held_q = zeros<N, Scalar>();
  Vector<N, Scalar> held_dq = zeros<N, Scalar>();
  std::uint64_t held_since = 0;  // of the waiting ticks
  // Of each joint, since arming: the torque rate has let through what is wanted.
  PerJoint<N, bool> torque_is_in{};
  // It has of all, every drive was in torque mode, and the arm at rest: time has begun.
  bool drives_follow = false;
  ReferenceRamp<N, Scalar> ramp;  // from the sample at time 0
};

template <int N, typename Scalar>
class Takeover {
 public:
  using Data = TakeoverData<N, Scalar>;

  Takeover() = default;
  // Of a configuration that validate() accepts.
  template <typename Space>
  explicit Takeover(const ControllerConfig<N, Scalar, Space>& config)
      : arming_(config.arming), time_to_follow_us_(config.time_to_follow_us) {
    double swing_s = 0;
    for (std::size_t j = 0; j < config.arming.torque_rate.size(); ++j) {
      const Scalar limit = config.monitor.chain.joints[j].max_torque;
      swing_s = std::max(swing_s, static_cast<double>(limit / config.arming.torque_rate[j]));
    }
    // From one limit to the other, and for the arm to come to rest.
    const double time_s = 2 * swing_s + static_cast<double>(config.arming.ramp_s);
    constexpr double kMost = 10;  // nobody waits longer beside an arm, whatever the rate
    time_to_hold_us_ = static_cast<Microseconds>(1e6 * std::min(time_s, kMost));
    const Scalar period_s = config.monitor.estimator.period_s;
    period_s_ = static_cast<double>(period_s);
    period_us_ = static_cast<Microseconds>(Scalar(1e6) * period_s + Scalar(0.5));
  }

  void reset(Data& data) const {
    data = {};
    size_for(arming_.speed.size(), data.held_q, data.held_dq, data.torque_is_in, data.ramp.q,
             data.ramp.dq);
  }

  // In a tick of an armed controller: kNone, or why it has to end. Drives that have followed once
  // have fallen back where they do not.
  [[nodiscard]] Fault judge(bool in_torque_mode, Microseconds drive_max_age_us,
                            const Data& data) const {
    if (data.drives_follow) return in_torque_mode ? Fault::kNone : Fault::kDriveNotFollowing;
    const Microseconds waited_us = static_cast<Microseconds>(data.waiting_ticks) * period_us_;
    const Microseconds follow_us = time_to_follow_us_ + drive_max_age_us;
    if (!in_torque_mode && waited_us > follow_us) return Fault::kDriveNotFollowing;
    return waited_us > follow_us + time_to_hold_us_ ? Fault::kArmNotHeld : Fault::kNone;
  }

  // At a sample from which time might begin, with `reference` at time 0: kNone, or kArmNotHeld
  // where the arm has left the window that it was armed in.
  [[nodiscard]] Fault hold(const JointSample<N, Scalar>& sample,
                           const Reference<N, Scalar>& reference, Data& data) const {
    if (!data.holds) {
      data.holds = true;
      data.held_q = sample.q;
      data.held_dq = sample.dq;
      data.held_since = data.waiting_ticks;
    }
    data.ramp.q = reference.q - sample.q;
    data.ramp.dq = reference.dq - sample.dq;
    const Vector<N, Scalar> way = sample.q - data.held_q;
    return all_within(way, arming_.position_window) ? Fault::kNone : Fault::kArmNotHeld;
  }

  // Where the arm is to be until time begins: it comes to rest, within ramp_s, where it was.
  [[nodiscard]] Reference<N, Scalar> held(const Data& data) const {
    Reference<N, Scalar> reference;
    ReferenceRamp<N, Scalar> rest;
    size_for(arming_.speed.size(), reference.dq, reference.ddq, rest.q);
    reference.q = data.held_q;
    rest.dq = -data.held_dq;
    const auto ticks = static_cast<double>(data.waiting_ticks - data.held_since);
    ramp_in(rest, ticks * period_s_, arming_.ramp_s, reference);
    return reference;
  }

  // At a sample with every drive in torque mode, right after one that hold() has had: whether time
  // began with that one.
  [[nodiscard]] bool is_over(const JointSample<N, Scalar>& sample, const Data& data) const {
    return std::all_of(data.torque_is_in.begin(), data.torque_is_in.end(),
                       [](bool of_joint) { return of_joint; }) &&
           all_within(sample.dq, arming_.speed);
  }

 private:
  static bool all_within(const Vector<N, Scalar>& values, const PerJoint<N, Scalar>& most) {
    for (std::size_t j = 0; j < most.size(); ++j) {
      if (!is_within(values[static_cast<Eigen::Index>(j)], most[j])) return false;
    }
    return true;
  }

  ArmingConfig<N, Scalar> arming_;
  Microseconds time_to_follow_us_ = 0;
  Microseconds time_to_hold_us_ = 0;
  Microseconds period_us_ = 0;
  double period_s_ = 0;
};

}  // namespace offnominal::controller
