// The paper's arm, under gravity, behind two emulated ODrives, and its controller, at the two ends
// of an in-process bus, in lock-step.
#pragma once

#include <array>
#include <memory>
#include <numbers>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/can_simple/can_simple.hpp>

#include "arm_on_bus.hpp"
#include "offnominal/sim/bus/odrive_axis.hpp"
#include "offnominal/sim/trajectory.hpp"
#include "offnominal/sim/two_link_plant.hpp"

namespace offnominal::test {

struct OdriveSetup {
  hal::CanSimpleFirmware firmware = hal::CanSimpleFirmware::k06;
  hal::CanSimpleConfig driver{};
  sim::OdriveConfig axis{};  // node and firmware are set from the rest
  ArmOnBus::Controller::Config controller = ArmOnBus::config(false);
  sim::Fault fault{};
};

class OdriveArm {
 public:
  static constexpr std::size_t kJoints = 2;
  using Controller = ArmOnBus::Controller;

  explicit OdriveArm(const OdriveSetup& setup)
      : plant_({}, setup.fault, sim::paper_uncertainty()), drives_(setup.driver, axes_of(setup)) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      sim::OdriveConfig config = setup.axis;
      config.node = kNodes[j];
      config.firmware_06 = setup.firmware == hal::CanSimpleFirmware::k06;
      axes.emplace_back(config);
    }
    if (Controller::create(setup.controller, controller) != Status::kOk) {
      throw std::logic_error("refused");
    }
  }

  // One period: the drives obey, the arm moves, they report, then the controller has its tick.
  void tick() {
    now_us_ += 1000;
    net_.set_time(now_us_);
    receive();
    for (sim::OdriveAxis& axis : axes) axis.tick();
    move();
    publish();
    if (!controller_runs) return;
    controller.step(now_us_, 0, ArmOnBus::paper_reference, controller_port_, drives_, *data);
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  // Until the controller is in this state, so many ticks at most; how many it took.
  int run_until(hal::ControllerState state, int most) {
    int ticks = 0;
    for (; ticks < most && data->state != state; ++ticks) tick();
    return ticks;
  }
  [[nodiscard]] bool start() {
    run_until(hal::ControllerState::kPassive, 500);
    return arm() == controller::Fault::kNone;
  }
  controller::Fault arm() { return controller.arm(ArmOnBus::paper_reference, *data); }
  [[nodiscard]] bool clear_fault() { return controller.clear_fault(drives_, *data); }
  // What the bus carries from the controller to the drives.
  void lose_commands(bool lost) { commands_lost_ = lost; }

  [[nodiscard]] double time_s() const { return 0.001 * static_cast<double>(moves_); }
  // From where the controller wants it to be.
  [[nodiscard]] double tracking_error_rad() const {
    return (sim::paper_trajectory(0.001 * static_cast<double>(data->run_ticks)).q - state_.q)
        .norm();
  }
  [[nodiscard]] bool gives_torque() const {
    return axes[0].torque_nm() != 0 || axes[1].torque_nm() != 0;
  }
  // Of a joint, as it acts.
  [[nodiscard]] double joint_torque_nm(std::size_t joint) const {
    return axes[joint].torque_nm() / motor_share(joint);
  }
  [[nodiscard]] const hal::CanSimpleDrives<kJoints>& drives() const { return drives_; }

  std::vector<sim::OdriveAxis> axes;
  Controller controller;
  std::unique_ptr<Controller::Data> data = std::make_unique<Controller::Data>();
  bool controller_runs = true;

 private:
  static constexpr std::array<std::uint8_t, kJoints> kNodes{3, 44};
  // The first joint on the motor's shaft, the second behind a gear of 10 that reverses.
  static constexpr std::array<double, kJoints> kJointPerTurn{2 * std::numbers::pi,
                                                             -2 * std::numbers::pi / 10};

  static std::array<hal::CanSimpleAxis, kJoints> axes_of(const OdriveSetup& setup) {
    std::array<hal::CanSimpleAxis, kJoints> axes;
    for (std::size_t j = 0; j < kJoints; ++j) {
      axes[j] = {kNodes[j], static_cast<float>(kJointPerTurn[j]), setup.firmware,
                 static_cast<float>(setup.axis.torque_constant)};
    }
    return axes;
  }
  static double motor_share(std::size_t joint) {
    return kJointPerTurn[joint] / (2 * std::numbers::pi);
  }

  void receive() {
    std::array<hal::ReceivedFrame, 16> frames;
    const std::size_t count = plant_port_.receive(frames);
    for (std::size_t i = 0; i < count && !commands_lost_; ++i) {
      for (sim::OdriveAxis& axis : axes) axis.take(frames[i].frame);
    }
  }
  // Until both axes are in closed loop, brakes hold the arm.
  void move() {
    for (const sim::OdriveAxis& axis : axes) {
      started_ = started_ || (axis.state() == sim::OdriveAxis::kClosedLoop &&
                              axes[0].state() == axes[1].state());
    }
    if (!started_) return;
    state_ = plant_.step(time_s(), state_, {joint_torque_nm(0), joint_torque_nm(1)}, 0.001, 1);
    ++moves_;
  }
  void publish() {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const double turns = state_.q[i] / kJointPerTurn[j];
      for (const hal::Frame& frame : axes[j].frames(turns, state_.dq[i] / kJointPerTurn[j])) {
        static_cast<void>(plant_port_.send(frame, now_us_ + 1000));
      }
    }
  }

  using Net = hal::InProcessNet<2>;
  Net net_;
  Net::Port controller_port_ = net_.port(0);
  Net::Port plant_port_ = net_.port(1);
  sim::TwoLinkPlant plant_;
  sim::TwoLinkState state_{sim::paper_trajectory(0.0).q, sim::paper_trajectory(0.0).dq};
  hal::CanSimpleDrives<kJoints> drives_;
  hal::Microseconds now_us_ = 0;
  std::int64_t moves_ = 0;
  bool started_ = false;
  bool commands_lost_ = false;
};

}  // namespace offnominal::test
