#pragma once

#include <memory>
#include <span>

#include "wcet/tick.hpp"

namespace offnominal::desk::wcet {

using TickFactory = std::unique_ptr<Tick>(const RobotDescription& robot, Precision precision,
                                          hal::FrameFormat format);

/// A controller that is compiled in, with a monitor of either space.
struct TickSize {
  int joints = 0;
  int hidden_units = 0;  // at most
  TickFactory* make = nullptr;
  TickFactory* make_in_torque_space = nullptr;
};

[[nodiscard]] std::span<const TickSize> tick_sizes();

}  // namespace offnominal::desk::wcet
