// Runs of two seconds with a robot file at both ends of an in-process bus.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

inline Scenario scenario_of(const RobotDescription& robot,
                            std::vector<sim::FaultEvent> faults = {}) {
  Scenario scenario;
  scenario.plant = robot;
  scenario.faults = std::move(faults);
  scenario.duration_s = 2.0;
  return scenario;
}

inline SilResult run(const RobotDescription& robot, const Scenario& scenario,
                     const TappedPort::OnFrame& on_frame = {}) {
  const auto wire = make_in_process_wire();
  return run_in_lock_step(robot, scenario, *wire, kInProcess, on_frame);
}

inline std::string refusal(const RobotDescription& robot, const Scenario& scenario) {
  try {
    static_cast<void>(run(robot, scenario));
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was refused";
}

}  // namespace offnominal::desk::sil
