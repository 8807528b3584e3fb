// The loop of a run.
#pragma once

#include "paper/run_observer.hpp"
#include "sil/sil.hpp"

namespace offnominal::desk::sil {

/// Fills what the loop itself sees: everything but `run`, which `observe` is for.
void run_loop(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
              const TappedPort::OnFrame& on_frame, const paper::TickObserver& observe,
              SilResult& result);

}  // namespace offnominal::desk::sil
