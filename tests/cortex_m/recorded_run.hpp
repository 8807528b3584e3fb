// A run of the paper's arm under the joint controller over a bus, as the frames that came in.
#pragma once

#include <vector>

#include "firmware/replay_run.hpp"
#include "offnominal/sim/fault.hpp"

namespace offnominal::test {

/// From cold, 20 s with the fault at 10 s as in the paper, without compensation. One entry per
/// tick.
[[nodiscard]] std::vector<cortex_m::ReplayTick> recorded_run(sim::FaultKind kind);

}  // namespace offnominal::test
