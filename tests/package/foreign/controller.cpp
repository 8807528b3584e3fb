#include <array>
#include <cmath>
#include <cstdio>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>

#include "robot_model.hpp"

// A joint controller from the installed package and a generated model, on a bus inside the program:
// at its other end the paper's arm lies still, stretched out, and has to be held.

namespace {

namespace hal = offnominal::hal;

constexpr auto kJoints = static_cast<std::size_t>(robot_model::kJoints);
using Controller =
    offnominal::controller::JointController<robot_model::kJoints, robot_model::kHiddenUnits, float>;
using Net = hal::InProcessNet<2>;

// Encoders at rest and drives that give what they were told: their frames of one tick.
bool send_readings(Net::Port& bus, std::uint8_t counter,
                   const std::array<float, kJoints>& torque_nm) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    const auto node = static_cast<std::uint8_t>(j);
    hal::Record record{};
    bool good =
        encode(hal::EncoderReading{0, 0, true}, counter,
               hal::data_id_of(hal::MessageKind::kEncoder, node), record) == hal::Status::kOk;
    good = good && bus.send(hal::frame_of(hal::MessageKind::kEncoder, node, record), bus.now()) ==
                       hal::Status::kOk;
    good = good && encode(hal::DriveStatus{hal::DriveMode::kTorque, 0, torque_nm[j]}, counter,
                          hal::data_id_of(hal::MessageKind::kDriveStatus, node),
                          record) == hal::Status::kOk;
    good = good && bus.send(hal::frame_of(hal::MessageKind::kDriveStatus, node, record),
                            bus.now()) == hal::Status::kOk;
    if (!good) return false;
  }
  return true;
}

}  // namespace

int main() {
  const Controller::Config config = offnominal::controller::controller_config(
      robot_model::kMonitorConfig<float>, robot_model::kComputedTorqueGains<float>,
      robot_model::kArmingConfig<float>);
  static Controller controller;
  if (Controller::create(config, controller) != offnominal::Status::kOk) return 2;

  static Net net;
  Net::Port arm = net.port(0);
  Net::Port bus = net.port(1);
  hal::ProtectedDrives<kJoints> drives({}, {}, hal::FrameFormat::kClassic);
  static Controller::Data data;
  const auto at_rest = [](double) { return offnominal::Reference<robot_model::kJoints, float>{}; };
  std::array<float, kJoints> torque_nm{};
  for (std::uint8_t tick = 1; tick <= 100; ++tick) {
    net.set_time(1000 * tick);
    if (!send_readings(arm, tick, torque_nm)) return 2;
    controller.step(net.now(), 0, at_rest, bus, drives, data);
    using offnominal::controller::Fault;
    if (tick == 20 && controller.arm(at_rest, data) != Fault::kNone) return 2;
    for (std::size_t j = 0; j < kJoints; ++j) torque_nm[j] = data.commands[j].torque;
  }
  if (data.state != hal::ControllerState::kArmed || data.output.detector.latched) return 1;
  // 9.81 m/s^2 (0.5 kg 1 m + 2 kg 2 m) at the first joint.
  if (std::fabs(torque_nm[0] - 44.145F) > 0.01F) return 1;
  std::printf("%s is held with %.3f N m\n", robot_model::kJointNames[0],
              static_cast<double>(torque_nm[0]));
  return 0;
}
