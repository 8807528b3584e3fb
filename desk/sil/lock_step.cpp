#include "sil/lock_step.hpp"

#include <cmath>
#include <optional>

#include "sil/both_ends.hpp"
#include "sil/not_held.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::sil {
namespace {

class LockStepLoop {
 public:
  LockStepLoop(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
               const TappedPort::OnFrame& on_frame)
      : robot_(robot),
        scenario_(scenario),
        period_s_(robot.estimator.period_s),
        ticks_(std::llround(scenario.duration_s / period_s_)),
        first_fault_s_(first_begin_s(scenario.faults)),
        ends_(robot, scenario, wire, on_frame) {}

  void run(const paper::TickObserver& observe, SilResult& result) {
    ends_.start();
    const sim::JointState held = ends_.plant().state();
    // Both ends have a tick in which they do what time 0 asks for.
    ends_.tick();
    std::optional<double> safe_since_s;
    bool was_armed = false;
    for (std::int64_t i = 1; i <= ticks_; ++i) {
      ends_.tick();
      const bool armed = ends_.controller().state() == hal::ControllerState::kArmed;
      // What it stops for is of the tick that stops it.
      const bool stops = was_armed && ends_.controller().fault() == controller::Fault::kDetected;
      if (armed || stops) observe(record());
      was_armed = armed;
      if (!result.not_held && ends_.controller().fault() == controller::Fault::kArmNotHeld) {
        result.not_held = not_held(robot_, scenario_, held, ends_.plant().state());
      }
      if (!safe_since_s && ends_.is_safe()) {
        safe_since_s = ends_.plant().time_s();
        // What came before the first fault was not its doing.
        if (first_fault_s_ && *safe_since_s >= *first_fault_s_) {
          result.time_to_safe_state_s = *safe_since_s - *first_fault_s_;
        }
      }
      constexpr double kAfterwards = 0.1;
      if (safe_since_s && ends_.plant().time_s() > *safe_since_s + kAfterwards) {
        result.ended_early_s = *safe_since_s;
        break;
      }
    }
    report(result);
  }

 private:
  [[nodiscard]] paper::TickRecord record() const {
    const ControllerView view = ends_.controller().view();
    paper::TickRecord record;
    record.tick = static_cast<std::int64_t>(view.run_ticks);
    record.time_s = ends_.plant().time_s();
    record.state = ends_.plant().state();
    record.q_desired =
        ends_.motion()(judging_time_s(scenario_, record.time_s - view.behind_s, view.motion_time_s))
            .q;
    record.tau = ends_.plant().applied_nm();
    record.psi = ends_.plant().plant().fault_function(record.time_s, record.tau);
    record.psi_hat = view.psi_hat;
    record.error_norm = view.error_norm;
    record.threshold = view.threshold;
    record.weight_norm = view.weight_norm;
    record.detected = view.detected;
    record.acts = view.acts;
    record.slows = view.slows;
    record.error = view.error;
    record.thresholds = view.thresholds;
    record.fast_error = view.fast_error;
    record.fast_thresholds = view.fast_thresholds;
    record.first_joint = view.first_joint;
    // Before the drives follow, a sample holds the torque that is asked for.
    record.bus = {view.fresh && view.drives_follow, view.seen, view.tau, ends_.plant().acting_nm(),
                  view.compensation};
    return record;
  }

  void report(SilResult& result) const {
    const hal::BusState at_controller = ends_.controller_bus();
    const hal::BusState at_plant = ends_.plant_bus();
    result.bus.frames = std::uint64_t{at_controller.sent} + at_plant.sent;
    result.bus.late = std::uint64_t{at_controller.late} + at_plant.late;
    const ControllerTotals totals = ends_.controller().totals();
    result.bus.stale = totals.missed_samples;
    const hal::DriveCounts of_commands = ends_.plant().drives().counts();
    result.bus.lost = totals.counts.lost + of_commands.lost;
    result.bus.rejected = totals.counts.rejected + of_commands.rejected;
    result.state = ends_.controller().state();
    result.fault = ends_.controller().fault();
    result.overruns = totals.overruns;
    result.isolated = ends_.controller().view().isolated;
    result.run_time_s = static_cast<double>(ends_.now_us()) * 1e-6;
  }

  const RobotDescription& robot_;
  const Scenario& scenario_;
  double period_s_;
  std::int64_t ticks_;
  std::optional<double> first_fault_s_;
  BothEnds ends_;
};

}  // namespace

void run_loop(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
              const TappedPort::OnFrame& on_frame, const paper::TickObserver& observe,
              SilResult& result) {
  LockStepLoop(robot, scenario, wire, on_frame).run(observe, result);
}

}  // namespace offnominal::desk::sil
