// The joint controller of the robot in robot_model.hpp, which `offnominal codegen` writes and the
// project puts where its compiler finds it: all that a tick's interrupt calls, on whichever bus.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/bus/bus.hpp>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <robot_model.hpp>

// What a model says whose robot file has no [drives]: found only where the model itself has no
// such name.
namespace offnominal::controller::without_drives {
using DriveProtocol = hal::Protected;
inline constexpr hal::DriveValues kDriveValues{};
}  // namespace offnominal::controller::without_drives
namespace robot_model {
using namespace offnominal::controller::without_drives;
}

namespace offnominal::controller {

template <hal::Bus Bus, typename Scalar>
class JointFirmware {
 public:
  static constexpr int kJoints = robot_model::kJoints;
  static constexpr auto kPeriodUs =
      static_cast<hal::Microseconds>(robot_model::kEstimatorConfig<double>.period_s * 1e6 + 0.5);
  using Drives = robot_model::DriveProtocol::Drives<static_cast<std::size_t>(kJoints)>;
  using Controller =
      JointController<kJoints, robot_model::kHiddenUnits, Scalar, robot_model::Memory,
                      robot_model::Space, robot_model::Isolates>;
  using Data = typename Controller::Data;

  explicit JointFirmware(Bus& bus)
      : bus_(bus),
        drives_(robot_model::DriveProtocol::drives<static_cast<std::size_t>(kJoints)>(
            robot_model::kDriveValues, {.period_us = kPeriodUs})) {}

  // That of the robot's constants, for a firmware that changes what they do not say: at_detection,
  // safe_mode.
  [[nodiscard]] static typename Controller::Config config() {
    return controller_config(robot_model::kMonitorConfig<Scalar>,
                             robot_model::kComputedTorqueGains<Scalar>,
                             robot_model::kArmingConfig<Scalar>);
  }

  // What Controller::create() says of it. Without kOk there must be no tick.
  [[nodiscard]] Status start(const typename Controller::Config& of_robot = config()) {
    return Controller::create(of_robot, controller_);
  }

  // One tick that began at begin_us on the bus's clock, late_ticks whole periods too late.
  // reference_at(time_s): where the joints should be, so long after arming.
  template <typename ReferenceAt>
  void tick(hal::Microseconds begin_us, std::uint32_t late_ticks, const ReferenceAt& reference_at) {
    controller_.step(begin_us, late_ticks, reference_at, bus_, drives_, data_);
  }

  // As the controller's functions of these names; in the interrupt of the tick, or with it masked.
  template <typename ReferenceAt>
  [[nodiscard]] Fault arm(const ReferenceAt& reference_at) {
    return controller_.arm(reference_at, data_);
  }
  [[nodiscard]] bool disarm() { return controller_.disarm(data_); }
  [[nodiscard]] bool clear_fault() { return controller_.clear_fault(drives_, data_); }

  [[nodiscard]] const Data& data() const { return data_; }

 private:
  Bus& bus_;
  Drives drives_;
  Controller controller_;
  Data data_;
};

}  // namespace offnominal::controller
