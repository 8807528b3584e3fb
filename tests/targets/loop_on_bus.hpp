// The controller's real-time loop with the paper's arm at the other end of an in-process bus, and
// time in the test's hands.
#pragma once

#include <functional>
#include <memory>
#include <offnominal/hal/bus/in_process_bus.hpp>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <offnominal/realtime/control_loop.hpp>
#include <offnominal/realtime/recorded_bus.hpp>

#include "arm_on_bus.hpp"

namespace offnominal::test {

// A timer's tick is the arm's, and whatever the test does in it.
class ScriptedTimer {
 public:
  std::function<void(int tick)> before_tick = [](int) {};
  std::uint32_t late_ticks = 0;  // of the next tick

  ScriptedTimer(hal::InProcessNet<2>& net, sim::PlantNode& plant)
      : net_(net), plant_port_(net.port(1)), plant_(plant) {}

  [[nodiscard]] realtime::Tick wait() {
    before_tick(++ticks_);
    now_us_ += (1 + late_ticks) * period_us();
    net_.set_time(now_us_);
    if (plant_runs) plant_.tick(now_us_ + period_us(), plant_port_);
    return {now_us_, 0, std::exchange(late_ticks, 0U)};
  }
  [[nodiscard]] static hal::Microseconds period_us() { return 1000; }
  bool plant_runs = true;

 private:
  hal::InProcessNet<2>& net_;
  hal::InProcessNet<2>::Port plant_port_;
  sim::PlantNode& plant_;
  hal::Microseconds now_us_ = 0;
  int ticks_ = 0;
};

class LoopOnBus {
 public:
  static constexpr int kHidden = 35;
  using Controller = controller::JointController<2, kHidden, float, WithMemory>;

  explicit LoopOnBus(const Controller::Config& config = ArmOnBus::config(false)) {
    if (Controller::create(config, controller_) != Status::kOk) {
      throw std::logic_error("refused");
    }
  }

  realtime::LoopReport run(const realtime::LoopConfig& config) {
    using Bus = realtime::RecordedBus<hal::InProcessNet<2>::Port>;
    hal::InProcessNet<2>::Port port = net_.port(0);
    Bus bus(port, recorder);
    using Loop = realtime::ControlLoop<2, kHidden, float, Bus, hal::ProtectedDrives<2>,
                                       ScriptedTimer, decltype(reference_at)>;
    Loop loop(config, {controller_, timer, bus, drives_, reference_at, recorder, panel, *data});
    return loop.run();
  }

  // From the arm's end of the bus.
  void send(const hal::Frame& frame) {
    static_cast<void>(net_.port(1).send(frame, net_.now() + 1000));
  }

 private:
  static constexpr hal::SourceConfig kSource{.max_age_us = 2500};
  hal::InProcessNet<2> net_;

 public:
  sim::PlantNode plant{paper_arm(), two_drives(), {}};
  ScriptedTimer timer{net_, plant};
  realtime::Recorder recorder;
  realtime::LoopPanel panel;
  std::unique_ptr<Controller::Data> data = std::make_unique<Controller::Data>();
  std::function<Reference<2, float>(double)> reference_at = ArmOnBus::paper_reference;

 private:
  hal::ProtectedDrives<2> drives_{kSource, kSource, hal::FrameFormat::kClassic};
  Controller controller_;
};

}  // namespace offnominal::test
