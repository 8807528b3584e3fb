#include "sil/plant_loop.hpp"

#include <algorithm>

namespace offnominal::desk {
namespace {

realtime::Row row_of(const sim::PlantNode& plant, realtime::Microseconds time_us) {
  const sim::JointVector& tau = plant.applied_nm();
  const sim::JointVector psi = plant.plant().fault_function(plant.time_s(), tau);
  realtime::Row row;
  row.time_us = time_us;
  std::size_t next = 0;
  for (const sim::JointVector* all :
       {&plant.state().q, &plant.state().dq, &tau, &psi, &plant.acting_nm()}) {
    for (const double value : *all) row.values[next++] = value;
  }
  row.values[next] = plant.time_s();
  row.digit = plant.drives().any_in_torque_mode() ? 1 : 0;
  return row;
}

}  // namespace

std::vector<std::string> plant_columns(int joints) {
  std::vector<std::string> columns;
  for (const char* quantity : {"q", "dq", "tau", "psi", "acting"}) {
    for (int joint = 1; joint <= joints; ++joint) {
      columns.push_back(quantity + std::to_string(joint));
    }
  }
  columns.insert(columns.end(), {"arm_t", "torque_mode"});
  return columns;
}

PlantReport run_plant(sim::PlantNode& plant, const sil::Scenario& scenario,
                      realtime::CycleTimer& timer, BusPort& port, realtime::Recorder& recorder,
                      const std::atomic<bool>& end) {
  sim::FaultyBus<BusPort> bus(port, sim::BusEnd::kPlant, plant.drives(), scenario.faults,
                              scenario.seed);
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
  report.in_torque_mode = plant.drives().any_in_torque_mode();
  report.counts = plant.drives().counts();
  report.bus = bus.state();
  return report;
}

}  // namespace offnominal::desk
