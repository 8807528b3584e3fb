// Body of run_loop(); included only where it is instantiated.
#pragma once

#include <cmath>
#include <memory>
#include <offnominal/controller/joint_controller.hpp>

#include "common/error.hpp"
#include "offnominal/sim/bus/faulty_bus.hpp"
#include "sil/controller_settings.hpp"
#include "sil/lock_step.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::tools::sil {

// Fewer hidden units are exactly a smaller network.
inline constexpr int kSilCapacity = 128;

template <typename Scalar>
class LockStepLoop {
 public:
  using Controller = controller::JointController<2, kSilCapacity, Scalar, WithMemory>;
  using Drives = hal::ProtectedDrives<2>;

  LockStepLoop(const RobotDescription& robot, const Scenario& scenario, const LoopSetup& setup,
               Wire& wire, const TappedPort::OnFrame& on_frame)
      : scenario_(scenario),
        setup_(setup),
        wire_(wire),
        controller_tap_(wire.controller(), on_frame),
        plant_tap_(wire.plant(), on_frame),
        controller_bus_(controller_tap_, sim::BusEnd::kController, scenario.faults, scenario.seed),
        plant_bus_(plant_tap_, sim::BusEnd::kPlant, scenario.faults, scenario.seed),
        source_(controller::source_config(setup.period_us)),
        drives_(source_, source_, scenario.format),
        plant_(plant_of(scenario, robot.estimator.period_s)) {
    create_controller(robot, settings_of(scenario), controller_);
  }

  void run(const paper::TickObserver& observe, SilResult& result) {
    start();
    // Both ends have a tick in which they do what time 0 asks for.
    tick();
    std::optional<double> safe_since_s;
    for (std::int64_t i = 1; i <= setup_.ticks; ++i) {
      tick();
      if (data_->state == hal::ControllerState::kArmed) observe(record());
      if (!safe_since_s && is_safe()) {
        safe_since_s = plant_.time_s();
        result.time_to_safe_state_s = *safe_since_s - setup_.first_fault_s;
      }
      constexpr double kAfterwards = 0.1;
      if (safe_since_s && plant_.time_s() > *safe_since_s + kAfterwards) {
        result.ended_early_s = *safe_since_s;
        break;
      }
    }
    report(result);
  }

 private:
  using Bus = sim::FaultyBus<BusPort>;

  void start() {
    constexpr int kPatience = 200;
    controller::Fault refusal = controller::Fault::kNotPassive;
    for (int i = 0; i < kPatience && passes_by_itself(refusal); ++i) {
      tick();
      refusal = controller_.arm(reference(), *data_);
    }
    if (refusal == controller::Fault::kNone) return;
    const bool unheard = passes_by_itself(refusal);
    throw InputError({.file = "sil",
                      .place = "start",
                      .found = unheard
                                   ? "no valid frames of every joint within 200 ticks"
                                   : std::string("arming refused: ") + controller::name_of(refusal),
                      .allowed = "",
                      .mend = unheard ? "let the faults on the bus begin later"
                                      : "docs/troubleshooting.md says what it asks for"});
  }

  [[nodiscard]] auto reference() const {
    return [this](double run_time_s) {
      const auto desired = scenario_.experiment.desired_at(run_time_s);
      return Reference<2, Scalar>{desired.q.template cast<Scalar>(),
                                  desired.dq.template cast<Scalar>(),
                                  desired.ddq.template cast<Scalar>()};
    };
  }

  void tick() {
    now_us_ += setup_.period_us;
    wire_.set_time(now_us_);
    const double time_s = plant_.time_s();
    plant_bus_.set_time(time_s);
    controller_bus_.set_time(time_s);
    plant_.tick(now_us_ + setup_.period_us, plant_bus_);
    controller_.step(now_us_, 0, reference(), controller_bus_, drives_, *data_);
  }

  [[nodiscard]] bool is_safe() const {
    return plant_.started() && plant_.drives().mode(0) != hal::DriveMode::kTorque &&
           plant_.drives().mode(1) != hal::DriveMode::kTorque;
  }

  [[nodiscard]] paper::TickRecord record() const {
    paper::TickRecord record;
    record.tick = static_cast<std::int64_t>(data_->run_ticks);
    record.time_s = plant_.time_s();
    record.state = plant_.state();
    record.q_desired = scenario_.experiment.desired_at(record.time_s).q;
    record.tau = {plant_.applied_nm()[0], plant_.applied_nm()[1]};
    record.psi = plant_.plant().fault_function(record.time_s, record.state, record.tau);
    record.psi_hat = data_->output.psi_hat.template cast<double>();
    record.error_norm = static_cast<double>(data_->output.error_norm);
    record.threshold = static_cast<double>(data_->output.threshold);
    record.weight_norm =
        std::sqrt(static_cast<double>(squared_norm(data_->monitor.estimator.weights)));
    record.detected = data_->output.detector.latched;
    const auto& seen = data_->sample;
    // Before the drives follow, a sample holds the torque that is asked for.
    record.bus = {data_->fresh && data_->drives_follow,
                  {seen.q.template cast<double>(), seen.dq.template cast<double>()},
                  seen.tau.template cast<double>(),
                  plant_.acting_nm()};
    return record;
  }

  void report(SilResult& result) const {
    const hal::BusState at_controller = controller_bus_.state();
    const hal::BusState at_plant = plant_bus_.state();
    result.bus.frames = std::uint64_t{at_controller.sent} + at_plant.sent;
    result.bus.late = std::uint64_t{at_controller.late} + at_plant.late;
    result.bus.stale = data_->missed_samples;
    for (std::size_t j = 0; j < 2; ++j) {
      for (const hal::Source* source :
           {&drives_.encoder_source(j), &drives_.drive_source(j), &plant_.drives().source(j)}) {
        result.bus.lost += source->lost;
        result.bus.rejected += std::uint64_t{source->rejected} + source->repeated;
      }
    }
    result.state = data_->state;
    result.fault = data_->fault;
    result.overruns = data_->overruns;
    result.run_time_s = static_cast<double>(now_us_) * 1e-6;
  }

  const Scenario& scenario_;
  const LoopSetup& setup_;
  Wire& wire_;
  TappedPort controller_tap_;
  TappedPort plant_tap_;
  Bus controller_bus_;
  Bus plant_bus_;
  hal::SourceConfig source_;
  Drives drives_;
  sim::PlantNode plant_;
  Controller controller_;
  // On the heap: 128 hidden units do not belong on a stack.
  std::unique_ptr<typename Controller::Data> data_ = std::make_unique<typename Controller::Data>();
  hal::Microseconds now_us_ = 0;
};

template <typename Scalar>
void run_loop(const RobotDescription& robot, const Scenario& scenario, const LoopSetup& setup,
              Wire& wire, const TappedPort::OnFrame& on_frame, const paper::TickObserver& observe,
              SilResult& result) {
  LockStepLoop<Scalar>(robot, scenario, setup, wire, on_frame).run(observe, result);
}

}  // namespace offnominal::tools::sil
