#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <offnominal/finite.hpp>
#include <offnominal/model/chain.hpp>
#include <offnominal/status.hpp>

namespace offnominal {

// How a controller takes hold of an arm: what it asks of the arm before, and how gently it begins.
// A person may stand beside it, so that nothing of this is left to chance: numbers that are not
// set, zero, are refused.
template <int N, typename Scalar>
struct ArmingConfig {
  PerJoint<N, Scalar> position_window{};  // most between reference and joint, > 0, rad or m
  // The joint's largest speed, and the most between its velocity and the reference's; > 0, rad/s
  // or m/s. A motion that starts on the move has to say so here.
  PerJoint<N, Scalar> speed{};
  // The commanded torque moves no faster than this, at arming and ever after; > 0, N m/s or N/s.
  PerJoint<N, Scalar> torque_rate{};
  // Time in which what is between reference and arm at arming fades out of the reference, > 0.
  Scalar ramp_s{};
};

// Of as many joints everywhere.
template <int N, typename Scalar>
[[nodiscard]] Status validate(const ArmingConfig<N, Scalar>& config) {
  const auto usable = [](Scalar value) { return is_finite(value) && value > 0; };
  for (std::size_t i = 0; i < config.speed.size(); ++i) {
    const bool good = usable(config.position_window[i]) && usable(config.speed[i]) &&
                      usable(config.torque_rate[i]);
    if (!good) return Status::kInvalidLimit;
  }
  return usable(config.ramp_s) ? Status::kOk : Status::kInvalidLimit;
}

// For an arm of which nothing else is known: it stands still, within 3 degrees or a centimetre of
// the reference, which fades in within a second; the torque takes 50 ms to a joint's limit.
template <int N, typename Scalar>
[[nodiscard]] constexpr ArmingConfig<N, Scalar> default_arming(const Chain<N, Scalar>& chain) {
  constexpr Scalar kLimitsPerSecond = 20;
  ArmingConfig<N, Scalar> config;
  config.ramp_s = 1;
  if constexpr (N == kRuntimeJoints) {
    for (auto* values : {&config.position_window, &config.speed, &config.torque_rate}) {
      values->assign(chain.joints.size(), Scalar(0));
    }
  }
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const bool turns = chain.joints[i].type == JointType::kRevolute;
    config.position_window[i] = turns ? Scalar(0.05) : Scalar(0.01);
    config.speed[i] = config.position_window[i];
    // Without a limit there is no arming, whatever the rate.
    const Scalar limit = chain.joints[i].max_torque;
    config.torque_rate[i] = limit < std::numeric_limits<Scalar>::max() / kLimitsPerSecond
                                ? kLimitsPerSecond * limit
                                : limit;
  }
  return config;
}

}  // namespace offnominal
