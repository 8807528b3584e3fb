#pragma once

#include <cstdint>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/hal/source.hpp>
#include <offnominal/monitor.hpp>

namespace offnominal::controller {

using hal::Microseconds;

template <int N, typename Scalar>
struct ControllerConfig {
  // max_compensation zero: the monitor watches and does not act.
  MonitorConfig<N, Scalar> monitor;
  ComputedTorqueGains<N, Scalar> gains;
  // A command that has not gone out so long after its tick began never does; below a period.
  Microseconds command_lifetime_us = 900;
  hal::DriveMode safe_mode = hal::DriveMode::kOff;  // kOff or kDamping
  std::uint8_t late_ticks_allowed = 3;              // in a row
  std::uint8_t ticks_to_follow = 5;  // until a drive has to be in the mode that it was told to take
  // For drives that send positions alone; monitor.bound.velocity_error has to hold its
  // velocity_error_bound() then. Its period_s is the monitor's.
  VelocityObserverConfig<Scalar> velocity_observer;
  bool stop_at_detection = false;  // a crossed threshold leads to the safe state
  // Watch in kPassive too: where brakes are open and somebody else moves the joints.
  bool watch_when_passive = false;
};

// A configuration whose times follow from the monitor's period, whatever that is: commands live for
// 0.9 of it, and the velocity observer settles within some ten of them.
template <int N, typename Scalar>
[[nodiscard]] ControllerConfig<N, Scalar> controller_config(
    const MonitorConfig<N, Scalar>& monitor, const ComputedTorqueGains<N, Scalar>& gains) {
  ControllerConfig<N, Scalar> config;
  config.monitor = monitor;
  config.gains = gains;
  const Scalar period_s = monitor.estimator.period_s;
  config.command_lifetime_us = static_cast<Microseconds>(Scalar(0.9e6) * period_s + Scalar(0.5));
  config.velocity_observer.period_s = period_s;
  config.velocity_observer.bandwidth_rad_s = Scalar(0.2) / period_s;
  return config;
}

// A reading is stale at the third tick without a new one.
[[nodiscard]] constexpr hal::SourceConfig source_config(Microseconds period_us) {
  return {.max_age_us = period_us * 5 / 2};
}

// The velocity observer as it runs.
template <int N, typename Scalar>
[[nodiscard]] VelocityObserverConfig<Scalar> observer_of(
    const ControllerConfig<N, Scalar>& config) {
  VelocityObserverConfig<Scalar> observer = config.velocity_observer;
  observer.period_s = config.monitor.estimator.period_s;
  return observer;
}

template <int N, typename Scalar>
[[nodiscard]] Status validate(const ControllerConfig<N, Scalar>& config) {
  if (const Status status = validate(config.gains); status != Status::kOk) return status;
  const auto period_us = static_cast<double>(config.monitor.estimator.period_s) * 1e6;
  const auto lifetime_us = static_cast<double>(config.command_lifetime_us);
  if (!(lifetime_us > 0 && lifetime_us <= period_us)) return Status::kInvalidLimit;
  if (config.safe_mode == hal::DriveMode::kTorque) return Status::kInvalidLimit;
  return validate(observer_of(config));
}

}  // namespace offnominal::controller
