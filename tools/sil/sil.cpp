#include "sil/sil.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <offnominal/hal/wire_time.hpp>

#include "common/error.hpp"
#include "paper/run_observer.hpp"
#include "sil/lock_step.hpp"

namespace offnominal::tools::sil {
namespace {

[[noreturn]] void refuse(const std::string& place, const std::string& found,
                         const std::string& allowed) {
  throw InputError({.file = "sil", .place = place, .found = found, .allowed = allowed, .mend = ""});
}

void check_fault(const sim::FaultEvent& fault, double duration_s) {
  const sim::FaultEventInfo& info = info_of(fault.kind);
  const std::string name(info.name);
  if (!info.unit.empty() && !(fault.size >= info.least && fault.size <= info.most)) {
    refuse(name + ", size", fmt::format("{:g}", fault.size),
           fmt::format("{:g} to {:g} {}", info.least, info.most, info.unit));
  }
  if (info.on_joint && (fault.joint < 0 || fault.joint > 1)) {
    refuse(name + ", joint", std::to_string(fault.joint + 1), "1 or 2");
  }
  if (!(fault.begin_s >= 0 && fault.begin_s <= duration_s)) {
    refuse(name + ", begin", fmt::format("{:g} s", fault.begin_s),
           fmt::format("0 s to the run's end, {:g} s", duration_s));
  }
  if (!(fault.end_s > fault.begin_s)) {
    refuse(name + ", end", fmt::format("{:g} s", fault.end_s), "after its begin");
  }
  if (!(fault.rate_per_s > 0)) {
    refuse(name + ", rate", fmt::format("{:g} 1/s", fault.rate_per_s), "above 0");
  }
}

// The arm's own fault, of which there is one at most.
sim::Fault arm_fault(const std::vector<sim::FaultEvent>& faults) {
  sim::Fault arm;
  for (const sim::FaultEvent& fault : faults) {
    if (!info_of(fault.kind).develops) continue;
    if (arm.kind != sim::FaultKind::kNone) {
      refuse("faults", "two of mass_loss, nonlinear and payload", "one of them");
    }
    arm.time_s = fault.begin_s;
    arm.rate_per_s = fault.rate_per_s;
    if (fault.kind == sim::FaultEventKind::kMassLoss) {
      arm.kind = sim::FaultKind::kMassLoss;
      arm.mass_loss = fault.size;
    } else if (fault.kind == sim::FaultEventKind::kPayload) {
      arm.kind = sim::FaultKind::kPayload;
      arm.payload_kg = fault.size;
    } else {
      arm.kind = sim::FaultKind::kNonlinear;
    }
  }
  return arm;
}

// What the arm does that its model does not know, with friction that comes and goes.
sim::Uncertainty with_friction(sim::Uncertainty base, const std::vector<sim::FaultEvent>& faults) {
  std::vector<sim::FaultEvent> jumps;
  std::copy_if(faults.begin(), faults.end(), std::back_inserter(jumps),
               [](const auto& fault) { return fault.kind == sim::FaultEventKind::kFrictionJump; });
  if (jumps.empty()) return base;
  return [base = std::move(base), jumps](double time_s, const sim::JointState& state) {
    constexpr double kSignWidth = 0.01;  // rad/s
    Eigen::Vector2d torque = base(time_s, state);
    for (const sim::FaultEvent& jump : jumps) {
      const double speed = state.dq[jump.joint];
      if (jump.is_active(time_s)) torque[jump.joint] += jump.size * std::tanh(speed / kSignWidth);
    }
    return torque;
  };
}

Scenario with_arm_faults(const Scenario& scenario) {
  Scenario complete = scenario;
  complete.experiment.fault = arm_fault(scenario.faults);
  complete.experiment.uncertainty = with_friction(scenario.experiment.uncertainty, scenario.faults);
  return complete;
}

}  // namespace

void check_scenario(const RobotDescription& robot, const Scenario& scenario) {
  paper::check_experiment(robot, scenario.experiment);
  constexpr int kMostHidden = 128;
  if (robot.estimator.hidden_units > kMostHidden) {
    refuse("hidden units", std::to_string(robot.estimator.hidden_units), "1 to 128");
  }
  if (scenario.encoder_bits_per_turn < 0 || scenario.encoder_bits_per_turn > 32) {
    refuse("encoder bits per turn", std::to_string(scenario.encoder_bits_per_turn), "0 to 32");
  }
  if (!(scenario.max_acceleration > 0 && std::isfinite(scenario.max_acceleration))) {
    refuse("largest acceleration", fmt::format("{:g} rad/s^2", scenario.max_acceleration),
           "above 0");
  }
  for (const sim::FaultEvent& fault : scenario.faults) {
    check_fault(fault, scenario.experiment.duration_s);
  }
  static_cast<void>(arm_fault(scenario.faults));
}

SilResult run_in_lock_step(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
                           const std::string& bus_name, const TappedPort::OnFrame& on_frame) {
  check_scenario(robot, scenario);
  const Scenario complete = with_arm_faults(scenario);
  const double period_s = robot.estimator.period_s;
  const double duration_s = scenario.experiment.duration_s;
  LoopSetup setup;
  setup.period_us = std::max<hal::Microseconds>(1, std::llround(1e6 * period_s));
  setup.ticks = std::llround(duration_s / period_s);
  setup.plant.period_s = period_s;
  setup.plant.substeps = scenario.experiment.plant_substeps;
  setup.plant.encoders.bits_per_turn = scenario.encoder_bits_per_turn;
  setup.plant.format = scenario.format;
  setup.plant.sends_velocity = scenario.sends_velocity;
  setup.plant.faults = scenario.faults;
  setup.plant.drives.commands.max_age_us = 5 * setup.period_us;
  SilResult result;
  result.bus_name = bus_name;
  result.faults = scenario.faults;
  std::optional<double> first_s;
  for (const sim::FaultEvent& fault : scenario.faults) {
    first_s = std::min(first_s.value_or(fault.begin_s), fault.begin_s);
  }
  setup.first_fault_s = first_s.value_or(0.0);
  paper::RunObserver observer(robot, complete.experiment, first_s.value_or(duration_s));
  const auto observe = [&](const paper::TickRecord& tick) { observer(tick); };
  double busy_s = 0;
  const auto see = [&](const hal::Frame& frame, hal::Microseconds time_us) {
    busy_s += hal::longest_wire_time_s(frame);
    if (on_frame) on_frame(frame, time_us);
  };
  if (scenario.experiment.precision == paper::Precision::kFloat) {
    run_loop<float>(robot, complete, setup, wire, see, observe, result);
  } else {
    run_loop<double>(robot, complete, setup, wire, see, observe, result);
  }
  result.run = observer.finish();
  if (result.run_time_s > 0) result.bus.load = busy_s / result.run_time_s;
  result.run.fault_time_s = first_s;
  return result;
}

std::string words_of(const std::vector<sim::FaultEvent>& faults) {
  if (faults.empty()) return "none";
  std::string words;
  for (const sim::FaultEvent& fault : faults) {
    const sim::FaultEventInfo& info = info_of(fault.kind);
    if (!words.empty()) words += ", ";
    words += info.name;
    if (info.on_joint) words += fmt::format(" on joint {}", fault.joint + 1);
    if (!info.unit.empty() && info.unit != "1") {
      words += fmt::format(" of {:g} {}", fault.size, info.unit);
    } else if (!info.unit.empty()) {
      words += fmt::format(" of {:g} %", 100 * fault.size);
    }
    words += fmt::format(" at {:g} s", fault.begin_s);
    if (std::isfinite(fault.end_s)) words += fmt::format(" until {:g} s", fault.end_s);
  }
  return words;
}

}  // namespace offnominal::tools::sil
