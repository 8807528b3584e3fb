// The loop of a run, for one precision.
#pragma once

#include <functional>

#include "paper/closed_loop.hpp"
#include "sil/sil.hpp"

namespace offnominal::tools::sil {

struct LoopSetup {
  hal::Microseconds period_us = 1000;
  std::int64_t ticks = 0;
  double first_fault_s = 0;
};

/// Fills what the loop itself sees: everything but `run`, which `observe` is for.
template <typename Scalar>
void run_loop(const RobotDescription& robot, const Scenario& scenario, const LoopSetup& setup,
              Wire& wire, const TappedPort::OnFrame& on_frame, const paper::TickObserver& observe,
              SilResult& result);

}  // namespace offnominal::tools::sil
