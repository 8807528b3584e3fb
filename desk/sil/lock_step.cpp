#include "sil/lock_step.hpp"

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "loop/stepped_controller.hpp"
#include "offnominal/sim/bus/faulty_bus.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::sil {
namespace {

ControllerSettings settings_of(const Scenario& scenario) {
  ControllerSettings settings;
  settings.accommodate = scenario.accommodate;
  settings.stop_at_detection = scenario.stop_at_detection;
  if (!scenario.sends_velocity) settings.max_acceleration = scenario.max_acceleration;
  settings.encoder_bits_per_turn = scenario.encoder_bits_per_turn;
  return settings;
}

class LockStepLoop {
 public:
  LockStepLoop(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
               const TappedPort::OnFrame& on_frame)
      : scenario_(scenario),
        period_s_(robot.estimator.period_s),
        period_us_(period_us_of(period_s_)),
        ticks_(std::llround(scenario.duration_s / period_s_)),
        first_fault_s_(first_begin_s(scenario.faults).value_or(0.0)),
        motion_(motion_of(scenario)),
        wire_(wire),
        controller_tap_(wire.controller(), on_frame),
        plant_tap_(wire.plant(), on_frame),
        plant_(plant_of(scenario, robot.drive_settings(), period_s_)),
        controller_bus_(controller_tap_, sim::BusEnd::kController, plant_.drives(), scenario.faults,
                        scenario.seed),
        plant_bus_(plant_tap_, sim::BusEnd::kPlant, plant_.drives(), scenario.faults,
                   scenario.seed),
        controller_(make_stepped_controller(
            {.robot = robot,
             .settings = settings_of(scenario),
             .link = {period_us_, format_of(scenario, robot.drive_settings(), period_s_)},
             .motion = motion_},
            scenario.precision)) {}

  void run(const paper::TickObserver& observe, SilResult& result) {
    start();
    // Both ends have a tick in which they do what time 0 asks for.
    tick();
    std::optional<double> safe_since_s;
    for (std::int64_t i = 1; i <= ticks_; ++i) {
      tick();
      if (controller_->state() == hal::ControllerState::kArmed) observe(record());
      if (!safe_since_s && is_safe()) {
        safe_since_s = plant_.time_s();
        result.time_to_safe_state_s = *safe_since_s - first_fault_s_;
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
      refusal = controller_->arm();
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

  void tick() {
    now_us_ += period_us_;
    wire_.set_time(now_us_);
    const double time_s = plant_.time_s();
    plant_bus_.set_time(time_s);
    controller_bus_.set_time(time_s);
    plant_.tick(now_us_ + period_us_, plant_bus_);
    controller_->step(now_us_, controller_port_);
  }

  [[nodiscard]] bool is_safe() const {
    return plant_.started() && !plant_.drives().any_in_torque_mode();
  }

  [[nodiscard]] paper::TickRecord record() const {
    const ControllerView view = controller_->view();
    paper::TickRecord record;
    record.tick = static_cast<std::int64_t>(view.run_ticks);
    record.time_s = plant_.time_s();
    record.state = plant_.state();
    record.q_desired = motion_(judging_time_s(scenario_, record.time_s,
                                              static_cast<double>(view.run_ticks) * period_s_))
                           .q;
    record.tau = plant_.applied_nm();
    record.psi = plant_.plant().fault_function(record.time_s, record.tau);
    record.psi_hat = view.psi_hat;
    record.error_norm = view.error_norm;
    record.threshold = view.threshold;
    record.weight_norm = view.weight_norm;
    record.detected = view.detected;
    record.error = view.error;
    record.thresholds = view.thresholds;
    record.first_joint = view.first_joint;
    // Before the drives follow, a sample holds the torque that is asked for.
    record.bus = {view.fresh && view.drives_follow, view.seen, view.tau, plant_.acting_nm()};
    return record;
  }

  void report(SilResult& result) const {
    const hal::BusState at_controller = controller_bus_.state();
    const hal::BusState at_plant = plant_bus_.state();
    result.bus.frames = std::uint64_t{at_controller.sent} + at_plant.sent;
    result.bus.late = std::uint64_t{at_controller.late} + at_plant.late;
    const ControllerTotals totals = controller_->totals();
    result.bus.stale = totals.missed_samples;
    const hal::DriveCounts of_commands = plant_.drives().counts();
    result.bus.lost = totals.counts.lost + of_commands.lost;
    result.bus.rejected = totals.counts.rejected + of_commands.rejected;
    result.state = controller_->state();
    result.fault = controller_->fault();
    result.overruns = totals.overruns;
    result.run_time_s = static_cast<double>(now_us_) * 1e-6;
  }

  const Scenario& scenario_;
  double period_s_;
  hal::Microseconds period_us_;
  std::int64_t ticks_;
  double first_fault_s_;
  MotionAt motion_;
  Wire& wire_;
  TappedPort controller_tap_;
  TappedPort plant_tap_;
  sim::PlantNode plant_;
  Bus controller_bus_;
  Bus plant_bus_;
  BusPortOf<Bus&> controller_port_{controller_bus_};
  std::unique_ptr<SteppedController> controller_;
  hal::Microseconds now_us_ = 0;
};

}  // namespace

void run_loop(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
              const TappedPort::OnFrame& on_frame, const paper::TickObserver& observe,
              SilResult& result) {
  LockStepLoop(robot, scenario, wire, on_frame).run(observe, result);
}

}  // namespace offnominal::desk::sil
