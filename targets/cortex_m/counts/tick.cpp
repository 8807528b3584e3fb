#include "rig.hpp"

using namespace offnominal::cortex_m;

void offnominal_tick(const Controller& controller,
                     const offnominal::Reference<kJoints, Scalar>& reference, Memory& memory) {
  controller.step(
      memory.bus.now(), 0, [&reference](double /*time_s*/) { return reference; }, memory.bus,
      memory.drives, memory.data);
}

offnominal::Status offnominal_monitor(const Controller& controller,
                                      const offnominal::JointSample<kJoints, Scalar>& sample,
                                      Memory& memory) {
  return controller.monitor().step(sample, memory.data.monitor, memory.data.output);
}
