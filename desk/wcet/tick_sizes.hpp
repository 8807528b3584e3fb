#pragma once

#include <memory>
#include <span>

#include "wcet/tick.hpp"

namespace offnominal::desk::wcet {

using TickFactory = std::unique_ptr<Tick>(const RobotDescription& robot, Precision precision,
                                          hal::FrameFormat format);

/// A controller that is compiled in.
struct TickSize {
  int joints = 0;
  int hidden_units = 0;  // at most
  TickFactory* make = nullptr;
};

[[nodiscard]] std::span<const TickSize> tick_sizes();

}  // namespace offnominal::desk::wcet
