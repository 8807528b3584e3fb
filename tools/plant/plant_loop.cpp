#include "plant/plant_loop.hpp"

#include <algorithm>

namespace offnominal::tools {
namespace {

realtime::Row row_of(const sim::PlantNode& plant, realtime::Microseconds time_us) {
  const Eigen::Vector2d tau(plant.applied_nm()[0], plant.applied_nm()[1]);
  const Eigen::Vector2d psi = plant.plant().fault_function(plant.time_s(), plant.state(), tau);
  realtime::Row row;
  row.time_us = time_us;
  std::size_t next = 0;
  for (const Eigen::Vector2d& pair :
       {plant.state().q, plant.state().dq, tau, psi, plant.acting_nm()}) {
    for (const double value : pair) row.values[next++] = value;
  }
  row.values[next] = plant.time_s();
  row.digit = plant.drives().mode(0) == hal::DriveMode::kTorque ||
                      plant.drives().mode(1) == hal::DriveMode::kTorque
                  ? 1
                  : 0;
  return row;
}

}  // namespace

std::vector<std::string> plant_columns() {
  return {"q1",   "q2",   "dq1",     "dq2",     "tau1",  "tau2",
          "psi1", "psi2", "acting1", "acting2", "arm_t", "torque_mode"};
}

PlantReport run_plant(sim::PlantNode& plant, const sil::Scenario& scenario,
                      realtime::CycleTimer& timer, sil::BusPort& port, realtime::Recorder& recorder,
                      const std::atomic<bool>& end) {
  sim::FaultyBus<sil::BusPort> bus(port, sim::BusEnd::kPlant, scenario.faults, scenario.seed);
  PlantReport report;
  while (!end.load(std::memory_order_relaxed)) {
    const realtime::Tick tick = timer.wait();
    ++report.ticks;
    if (tick.late_ticks > 0) ++report.overruns;
    plant.miss(tick.late_ticks);
    bus.set_time(plant.time_s());
    plant.tick(tick.begin_us + timer.period_us(), bus);
    if (plant.started()) recorder.keep(row_of(plant, tick.begin_us - tick.latency_us));
  }
  report.arm_time_s = plant.time_s();
  for (std::size_t j = 0; j < sim::PlantNode::kJoints; ++j) {
    report.in_torque_mode =
        report.in_torque_mode || plant.drives().mode(j) == hal::DriveMode::kTorque;
    report.lost += plant.drives().source(j).lost;
    report.rejected +=
        std::uint64_t{plant.drives().source(j).rejected} + plant.drives().source(j).repeated;
  }
  report.bus = bus.state();
  return report;
}

}  // namespace offnominal::tools
