// The joint controller of the robot in robot_model.hpp, which `offnominal codegen` writes: all that
// a tick's interrupt calls, on whichever bus.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/bus.hpp>
#include <offnominal/hal/protected_drives.hpp>
#include <robot_model.hpp>

namespace offnominal::cortex_m {

template <hal::Bus Bus, typename Scalar>
class JointFirmware {
 public:
  static constexpr int kJoints = robot_model::kJoints;
  static constexpr auto kPeriodUs =
      static_cast<hal::Microseconds>(robot_model::kEstimatorConfig<double>.period_s * 1e6 + 0.5);
  using Drives = hal::ProtectedDrives<static_cast<std::size_t>(kJoints)>;
  using Controller = controller::JointController<kJoints, robot_model::kHiddenUnits, Scalar>;
  using Data = typename Controller::Data;

  explicit JointFirmware(Bus& bus)
      : bus_(bus), drives_(kSource, kSource, hal::FrameFormat::kClassic) {}

  // What Controller::create() says of the robot's constants. Without kOk there must be no tick.
  [[nodiscard]] Status start() {
    typename Controller::Config config;
    config.monitor = robot_model::kMonitorConfig<Scalar>;
    config.gains = robot_model::kComputedTorqueGains<Scalar>;
    config.command_lifetime_us = kPeriodUs * 9 / 10;
    config.velocity_observer.period_s = config.monitor.estimator.period_s;
    return Controller::create(config, controller_);
  }

  // One tick that began at begin_us on the bus's clock, late_ticks whole periods too late.
  // reference_at(time_s): where the joints should be, so long after arming.
  template <typename ReferenceAt>
  void tick(hal::Microseconds begin_us, std::uint32_t late_ticks, const ReferenceAt& reference_at) {
    controller_.step(begin_us, late_ticks, reference_at, bus_, drives_, data_);
  }

  // As Controller::arm().
  [[nodiscard]] bool arm() { return controller_.arm(data_); }

  [[nodiscard]] const Data& data() const { return data_; }

 private:
  // Two ticks without a frame are borne, at the third the source is stale.
  static constexpr hal::SourceConfig kSource{.max_age_us = kPeriodUs * 5 / 2};

  Bus& bus_;
  Drives drives_;
  Controller controller_;
  Data data_;
};

}  // namespace offnominal::cortex_m
