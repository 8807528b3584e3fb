#include "sil/plant_of.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/error.hpp"

namespace offnominal::tools::sil {
namespace {

// The arm's own fault, of which there is one at most.
sim::Fault arm_fault(const std::vector<sim::FaultEvent>& faults) {
  sim::Fault arm;
  for (const sim::FaultEvent& fault : faults) {
    if (!info_of(fault.kind).develops) continue;
    if (arm.kind != sim::FaultKind::kNone) {
      throw InputError(
          {"sil", "faults", "two of mass_loss, nonlinear and payload", "one of them", ""});
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

}  // namespace

Scenario with_arm_faults(const Scenario& scenario) {
  Scenario complete = scenario;
  complete.experiment.fault = arm_fault(scenario.faults);
  complete.experiment.uncertainty = with_friction(scenario.experiment.uncertainty, scenario.faults);
  return complete;
}

void check_real_time(const Scenario& scenario) {
  for (const sim::FaultEvent& fault : scenario.faults) {
    if (fault.kind != sim::FaultEventKind::kBlockedBus &&
        fault.kind != sim::FaultEventKind::kBusOff) {
      continue;
    }
    throw InputError({"sil", std::string(info_of(fault.kind).name), "a run in real time",
                      "faults of the plant's end of the bus",
                      "this one is the controller's own: run it in lock-step"});
  }
}

sim::PlantNode plant_of(const Scenario& complete, double period_s) {
  sim::PlantNodeConfig config;
  config.period_s = period_s;
  config.substeps = complete.experiment.plant_substeps;
  config.encoders.bits_per_turn = complete.encoder_bits_per_turn;
  config.format = complete.format;
  config.sends_velocity = complete.sends_velocity;
  config.faults = complete.faults;
  config.drives.commands.max_age_us = 5 * period_us_of(period_s);
  sim::JointState start = sim::on_trajectory(complete.experiment.desired_at(0.0));
  // The brakes hold it where it is until the drives come. Released on the move it would have an
  // acceleration that no bound of an observer covers.
  if (!complete.sends_velocity) start.dq.setZero();
  return {paper::plant_of(complete.experiment), start, config};
}

hal::Microseconds period_us_of(double period_s) {
  return std::max<hal::Microseconds>(1, std::llround(1e6 * period_s));
}

std::optional<double> first_begin_s(const std::vector<sim::FaultEvent>& faults) {
  std::optional<double> first_s;
  for (const sim::FaultEvent& fault : faults) {
    first_s = std::min(first_s.value_or(fault.begin_s), fault.begin_s);
  }
  return first_s;
}

}  // namespace offnominal::tools::sil
