// Classic CAN where it is wide enough, CAN FD where it is not.
#pragma once

#include <offnominal/hal/protected_drives.hpp>
#include <optional>

namespace offnominal::tools {

/// Share of a bus's time that reading, status and command of every joint take at most, at
/// hal::BitRates and this period.
[[nodiscard]] double largest_load(int joints, double period_s, hal::FrameFormat format);

/// The wished format, or else the first of classic CAN and CAN FD that leaves room on the bus.
/// Throws InputError for a wish, or a robot, that takes more time than there is.
[[nodiscard]] hal::FrameFormat format_for(int joints, double period_s,
                                          std::optional<hal::FrameFormat> wished);

}  // namespace offnominal::tools
