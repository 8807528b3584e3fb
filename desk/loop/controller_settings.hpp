// The joint controller of a robot file, as software-in-the-loop and the controller program run it.
#pragma once

#include <algorithm>
#include <cmath>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/diagnosis/velocity_observer.hpp>
#include <optional>
#include <string>
#include <type_traits>

#include "common/error.hpp"
#include "common/number.hpp"
#include "loop/at_detection.hpp"
#include "loop/momentum_error.hpp"
#include "offnominal/sim/encoder.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::desk {

/// What a robot file does not say.
struct ControllerSettings : ActSettings {
  bool accommodate = false;
  hal::DriveMode safe_mode = hal::DriveMode::kOff;
  /// Largest acceleration of a joint, rad/s^2: the drives send positions alone, and it bounds the
  /// velocity observer's error. None: they send velocities.
  std::optional<double> max_acceleration;
  int encoder_bits_per_turn = 0;  // on top of what a frame resolves; 0: none
};

[[nodiscard]] inline hal::Microseconds period_us_of(double period_s) {
  return std::max<hal::Microseconds>(1, std::llround(1e6 * period_s));
}

/// Of every controller here: where a monitor can be asked which fault it is, the robot file says
/// whether it is.
template <typename Space>
using IsolationIn =
    std::conditional_t<std::is_same_v<Space, TorqueSpace>, WithIsolation, WithoutIsolation>;

namespace detail {

// What a velocity that is wrong by `error`, rad/s or m/s, on any joint adds to a bound.
template <int N, typename Scalar>
void add_velocity_error(const RobotDescription& /*robot*/, Scalar error,
                        UncertaintyBound<N, Scalar>& bound) {
  bound.velocity_error += error;
}
template <int N, typename Scalar>
void add_velocity_error(const RobotDescription& robot, Scalar error,
                        TorqueBound<N, Scalar>& bound) {
  const std::vector<double> per_velocity = momentum_per_velocity(robot);
  for (std::size_t i = 0; i < bound.joints.size(); ++i) {
    bound.joints[i].momentum_error += static_cast<Scalar>(per_velocity[i]) * error;
    if (bound.fast.alpha > 0) {
      bound.fast.joints[i].momentum_error = bound.joints[i].momentum_error;
    }
  }
}

}  // namespace detail

template <int N, typename Scalar, typename Space>
[[nodiscard]] controller::ControllerConfig<N, Scalar, Space> controller_config_of(
    const RobotDescription& robot, const ControllerSettings& settings) {
  auto config =
      controller::controller_config(monitor_config_of<N, Scalar, Space>(robot),
                                    gains_of<N, Scalar>(robot), arming_of<N, Scalar>(robot));
  config.safe_mode = settings.safe_mode;
  config.at_detection = settings.at_detection;
  config.slow_down = {static_cast<Scalar>(settings.slow_down.to),
                      static_cast<Scalar>(settings.slow_down.within_s)};
  config.isolates = robot.estimator.isolation;
  if (!settings.accommodate) config.monitor.max_compensation.fill(Scalar(0));
  const bool is_covered = robot.bound && robot.bound->covers_velocities;
  if (settings.max_acceleration && !is_covered) {
    sim::EncoderConfig encoder;
    encoder.bits_per_turn = settings.encoder_bits_per_turn;
    const double half_count =
        0.5 * (sim::position_step_rad(encoder) + static_cast<double>(hal::kPositionPerCount));
    const Scalar error = velocity_error_bound(config.velocity_observer,
                                              static_cast<Scalar>(*settings.max_acceleration),
                                              static_cast<Scalar>(half_count));
    detail::add_velocity_error(robot, error, config.monitor.bound);
  }
  return config;
}

/// Throws InputError where the controller refuses what the robot file says.
template <int N, int L, typename Scalar, typename Memory, typename Space, typename Isolates>
void create_controller(
    const RobotDescription& robot, const ControllerSettings& settings,
    controller::JointController<N, L, Scalar, Memory, Space, Isolates>& controller) {
  using Controller = controller::JointController<N, L, Scalar, Memory, Space, Isolates>;
  const double least_ramp_s = controller::kLeastRampPeriods * robot.estimator.period_s;
  if (robot.arming.ramp_s + robot.estimator.period_s / 2 < least_ramp_s) {
    throw InputError({.file = "robot " + robot.name,
                      .place = "arming.ramp_s",
                      .found = shortest(robot.arming.ramp_s) + " s",
                      .allowed = shortest(least_ramp_s) + " s or more, ten periods",
                      .mend = "in less, what is between reference and arm is a jump"});
  }
  const Status status =
      Controller::create(controller_config_of<N, Scalar, Space>(robot, settings), controller);
  if (status == Status::kOk) return;
  throw InputError({.file = "robot " + robot.name,
                    .place = "controller",
                    .found = std::string("status ") + name_of(status),
                    .allowed = "",
                    .mend = "docs/troubleshooting.md says what each status asks for"});
}

}  // namespace offnominal::desk
