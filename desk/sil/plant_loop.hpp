// A plant at its end of the bus in real time: what the thread of the plant program runs.
#pragma once

#include <atomic>
#include <cstdint>
#include <offnominal/realtime/cycle_timer.hpp>
#include <offnominal/realtime/recorder.hpp>
#include <string>
#include <vector>

#include "loop/bus_port.hpp"
#include "offnominal/sim/bus/faulty_bus.hpp"
#include "offnominal/sim/bus/plant_node.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk {

/// Plain data.
struct PlantReport {
  std::uint64_t ticks = 0;
  std::uint64_t overruns = 0;   // ticks that began a period or more too late
  double arm_time_s = 0;        // since the brakes opened; 0: they never did
  bool in_torque_mode = false;  // any drive, at the end
  hal::DriveCounts counts;      // of commands
  hal::BusState bus;
};

/// The columns of the rows that are recorded, for RecorderConfig::columns. A row stands for the end
/// of a tick: the torques, mean over it, have acted.
[[nodiscard]] std::vector<std::string> plant_columns(int joints);

/// Ticks until `end`. Ticks that were missed move the joints all the same, as time does not wait.
[[nodiscard]] PlantReport run_plant(sim::PlantNode& plant, const sil::Scenario& scenario,
                                    realtime::CycleTimer& timer, BusPort& port,
                                    realtime::Recorder& recorder, const std::atomic<bool>& end);

}  // namespace offnominal::desk
