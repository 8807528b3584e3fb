// The paper's arm and its controller at the two ends of an in-process bus, in lock-step.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>

#include "offnominal/sim/bus/joint_drives.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "offnominal/sim/plants/paper_arm.hpp"
#include "offnominal/sim/trajectory.hpp"
#include "paper/two_link_robot.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::test {

/// The paper's arm, with its uncertainty.
inline std::unique_ptr<sim::Plant> paper_arm(
    const sim::Fault& fault = {},
    const sim::JointState& start = sim::on_trajectory(sim::paper_trajectory(0.0))) {
  return std::make_unique<sim::PaperArm>(sim::TwoLinkPlant({}, fault, sim::paper_uncertainty()),
                                         start);
}

/// Drives with offnominal's own frames, in their default configuration.
inline std::unique_ptr<sim::Drives> two_drives(
    hal::FrameFormat format = hal::FrameFormat::kClassic) {
  return std::make_unique<sim::JointDrives>(2, sim::DriveConfig{}, format);
}

class ArmOnBus {
 public:
  using Scalar = float;
  using Controller = controller::JointController<2, 35, Scalar>;
  using Net = hal::InProcessNet<3>;
  static constexpr hal::Microseconds kPeriodUs = 1000;

  explicit ArmOnBus(const sim::Fault& fault = {}, bool accommodate = false,
                    hal::FrameFormat format = hal::FrameFormat::kClassic)
      : ArmOnBus(fault, config(accommodate), {}, sim::on_trajectory(sim::paper_trajectory(0.0)),
                 format) {}

  ArmOnBus(const sim::Fault& fault, const Controller::Config& config,
           const sim::PlantNodeConfig& plant,
           const sim::JointState& start = sim::on_trajectory(sim::paper_trajectory(0.0)),
           hal::FrameFormat format = hal::FrameFormat::kClassic)
      : drives_(kSource, kSource, format),
        plant_(paper_arm(fault, start), two_drives(format), plant) {
    if (Controller::create(config, controller) != Status::kOk) throw std::logic_error("refused");
  }

  static Controller::Config config(bool accommodate) {
    const desk::RobotDescription robot = desk::paper::two_link_robot();
    Controller::Config config = controller::controller_config(
        desk::monitor_config_of<2, Scalar>(robot), desk::gains_of<2, Scalar>(robot),
        desk::arming_of<2, Scalar>(robot));
    if (!accommodate) config.monitor.max_compensation = {};
    return config;
  }

  // One period: the plant moves and measures, then the controller has its tick.
  void tick() {
    now_us_ += kPeriodUs;
    net.set_time(now_us_);
    if (plant_runs) plant_.tick(now_us_ + kPeriodUs, plant_port_);
    tick_controller();
  }
  void tick_controller(std::uint32_t late_ticks = 0) {
    controller.step(now_us_, late_ticks, reference_at, controller_port_, drives_, *data);
  }
  // The plant goes on without the controller, whose next tick is then as many periods late.
  void tick_late(std::uint32_t periods) {
    for (std::uint32_t i = 0; i <= periods; ++i) {
      now_us_ += kPeriodUs;
      net.set_time(now_us_);
      plant_.tick(now_us_ + kPeriodUs, plant_port_);
    }
    tick_controller(periods);
  }
  void run(double seconds) {
    for (long i = std::lround(seconds * 1000); i > 0; --i) tick();
  }
  // From cold to commanding torque.
  bool start() {
    controller::Fault refusal = controller::Fault::kNotPassive;
    for (int i = 0; i < 100 && passes_by_itself(refusal); ++i) {
      tick();
      refusal = arm();
    }
    return refusal == controller::Fault::kNone;
  }
  controller::Fault arm() { return controller.arm(reference_at, *data); }
  bool clear_fault() { return controller.clear_fault(drives_, *data); }
  void stop(controller::Fault reason) { controller.stop(reason, controller_port_, *data); }

  [[nodiscard]] const sim::PlantNode& plant() const { return plant_; }
  [[nodiscard]] const hal::ProtectedDrives<2>& drives() const { return drives_; }
  [[nodiscard]] hal::Microseconds now() const { return now_us_; }

  static Reference<2, Scalar> paper_reference(double time_s) {
    const sim::DesiredMotion motion = sim::paper_trajectory(time_s);
    return {motion.q.cast<Scalar>(), motion.dq.cast<Scalar>(), motion.ddq.cast<Scalar>()};
  }

  std::function<Reference<2, Scalar>(double)> reference_at = paper_reference;
  Net net;  // port 0: controller, 1: plant, 2: whoever else
  bool plant_runs = true;
  Controller controller;
  std::unique_ptr<Controller::Data> data = std::make_unique<Controller::Data>();

 private:
  // Two ticks without a frame are borne, at the third the source is stale.
  static constexpr hal::SourceConfig kSource{.max_age_us = 2500};

  Net::Port controller_port_ = net.port(0);
  Net::Port plant_port_ = net.port(1);
  hal::ProtectedDrives<2> drives_;
  sim::PlantNode plant_;
  hal::Microseconds now_us_ = 0;
};

}  // namespace offnominal::test
