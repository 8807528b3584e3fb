#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <offnominal/control/arming.hpp>
#include <offnominal/control/computed_torque.hpp>
#include <offnominal/control/slow_down.hpp>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <offnominal/finite.hpp>
#include <offnominal/hal/drive_protocol.hpp>
#include <offnominal/monitor.hpp>

namespace offnominal::controller {

using hal::Microseconds;

// What a controller does when the monitor comes beyond the second level (JointBound::act_ratio,
// beyond the first one where there is no second). Compensation, which begins there too, is no
// choice among these: it goes with each of them but a stop, and MonitorConfig::max_compensation
// says how much of it there may be.
enum class AtDetection : std::uint8_t {
  kReport,  // nothing but to say so
  kSlow,    // the motion goes on more slowly, until it is armed anew
  kStop,    // the safe state
};

// What a controller is told beside its monitor.
template <int N, typename Scalar>
struct ControlConfig {
  ComputedTorqueGains<N, Scalar> gains;
  ArmingConfig<N, Scalar> arming;
  // No joint can be further from 0 than this, rad or m, whatever its limits: what says that it is
  // must be wrong.
  Scalar most_position = 1000;
  // A command that has not gone out so long after its tick began never does; below a period.
  Microseconds command_lifetime_us = 900;
  hal::DriveMode safe_mode = hal::DriveMode::kOff;  // kOff or kDamping
  // Ticks in a row that begin late; armed, also the periods by which one may.
  std::uint8_t late_ticks_allowed = 3;
  // From arming until every drive has to be in torque mode, besides its protocol's
  // drive_max_age_us(). The reference and the watch begin when all of them are and the arm is held,
  // which may take twice the longest way from 0 to a joint's torque limit, and ramp_s, more.
  Microseconds time_to_follow_us = 20000;
  // For drives that send positions alone; monitor.bound.velocity_error has to hold its
  // velocity_error_bound() then, in TorqueSpace every joint's momentum_error what M makes of it.
  // Its period_s is the monitor's.
  VelocityObserverConfig<Scalar> velocity_observer;
  AtDetection at_detection = AtDetection::kReport;
  SlowDownConfig<Scalar> slow_down;  // of AtDetection::kSlow
  // Of a controller WithIsolation: whether it asks which fault it is. It then compensates once that
  // is decided, and only for a kind that compensation is right for; without, from the detection on.
  bool isolates = true;
  // Watch in kPassive too: where brakes are open and somebody else moves the joints.
  bool watch_when_passive = false;
};

// Space: as of the Monitor.
template <int N, typename Scalar, typename Space = AccelerationSpace>
struct ControllerConfig : ControlConfig<N, Scalar> {
  // max_compensation zero: the monitor watches and does not act.
  MonitorConfig<N, Scalar, Space> monitor;
};

// A configuration whose times follow from the monitor's period, whatever that is: commands live for
// 0.9 of it, and the velocity observer has forgotten its start within some fifty of them.
template <int N, typename Scalar, typename Space>
[[nodiscard]] ControllerConfig<N, Scalar, Space> controller_config(
    const MonitorConfig<N, Scalar, Space>& monitor, const ComputedTorqueGains<N, Scalar>& gains,
    const ArmingConfig<N, Scalar>& arming) {
  ControllerConfig<N, Scalar, Space> config;
  config.monitor = monitor;
  config.gains = gains;
  config.arming = arming;
  const Scalar period_s = monitor.estimator.period_s;
  config.command_lifetime_us = static_cast<Microseconds>(Scalar(0.9e6) * period_s + Scalar(0.5));
  config.velocity_observer = velocity_observer_config(period_s);
  return config;
}

// With default_arming().
template <int N, typename Scalar, typename Space>
[[nodiscard]] ControllerConfig<N, Scalar, Space> controller_config(
    const MonitorConfig<N, Scalar, Space>& monitor, const ComputedTorqueGains<N, Scalar>& gains) {
  return controller_config(monitor, gains, default_arming(monitor.chain));
}

// The velocity observer as it runs.
template <int N, typename Scalar, typename Space>
[[nodiscard]] VelocityObserverConfig<Scalar> observer_of(
    const ControllerConfig<N, Scalar, Space>& config) {
  VelocityObserverConfig<Scalar> observer = config.velocity_observer;
  observer.period_s = config.monitor.estimator.period_s;
  return observer;
}

// Where a joint can be, rad or m: its limits, or where these say less what the configuration does.
template <int N, typename Scalar>
struct PositionRange {
  Vector<N, Scalar> lowest = zeros<N, Scalar>();
  Vector<N, Scalar> highest = zeros<N, Scalar>();
};

template <int N, typename Scalar, typename Space>
[[nodiscard]] PositionRange<N, Scalar> position_range_of(
    const ControllerConfig<N, Scalar, Space>& config) {
  PositionRange<N, Scalar> range;
  const std::size_t joints = config.monitor.chain.joints.size();
  size_for(joints, range.lowest, range.highest);
  for (std::size_t j = 0; j < joints; ++j) {
    const Joint<Scalar>& joint = config.monitor.chain.joints[j];
    const auto i = static_cast<Eigen::Index>(j);
    range.lowest[i] = std::max(joint.min_position, -config.most_position);
    range.highest[i] = std::min(joint.max_position, config.most_position);
  }
  return range;
}

// In fewer periods, to the nearest, a ramp is a jump: what is between reference and arm is gone
// before a drive has answered.
inline constexpr int kLeastRampPeriods = 10;

template <int N, typename Scalar, typename Space>
[[nodiscard]] Status validate(const ControllerConfig<N, Scalar, Space>& config) {
  if constexpr (N == kRuntimeJoints) {
    const std::size_t joints = config.monitor.chain.joints.size();
    const auto fits = [&](const auto& values) { return values.size() == joints; };
    const bool all_fit = fits(config.gains.kp) && fits(config.gains.kd) &&
                         fits(config.arming.position_window) && fits(config.arming.speed) &&
                         fits(config.arming.torque_rate);
    if (!all_fit) return Status::kWrongJointCount;
  }
  if (const Status status = validate(config.gains); status != Status::kOk) return status;
  if (const Status status = validate(config.arming); status != Status::kOk) return status;
  if (!is_finite(config.most_position) || config.most_position <= 0) {
    return Status::kInvalidLimit;
  }
  const auto period_us = static_cast<double>(config.monitor.estimator.period_s) * 1e6;
  const auto lifetime_us = static_cast<double>(config.command_lifetime_us);
  if (!is_finite(period_us) || lifetime_us <= 0 || lifetime_us > period_us)
    return Status::kInvalidLimit;
  if (config.safe_mode == hal::DriveMode::kTorque) return Status::kInvalidLimit;
  if (config.at_detection > AtDetection::kStop) return Status::kInvalidLimit;
  if (const Status status = validate(config.slow_down); status != Status::kOk) return status;
  if (config.time_to_follow_us < 0) return Status::kInvalidLimit;
  const Scalar period_s = config.monitor.estimator.period_s;
  if (config.arming.ramp_s < (kLeastRampPeriods - Scalar(0.5)) * period_s) {
    return Status::kInvalidLimit;
  }
  return validate(observer_of(config));
}

}  // namespace offnominal::controller
