// Classic CAN where it is wide enough, CAN FD where it is not.
#pragma once

#include <offnominal/hal/protected_drives.hpp>
#include <optional>

namespace offnominal::tools {

/// Share of a bus's time that reading, status and command of every joint take at most, at
/// hal::BitRates and this period.
[[nodiscard]] double largest_load(int joints, double period_s, hal::FrameFormat format);

/// Of the options --fd and --classic, of which one at most is given.
[[nodiscard]] inline std::optional<hal::FrameFormat> wished_format(bool fd, bool classic) {
  if (fd) return hal::FrameFormat::kFd;
  return classic ? std::optional(hal::FrameFormat::kClassic) : std::nullopt;
}

/// The wished format, or else the first of classic CAN and CAN FD that leaves room on the bus.
/// Throws InputError for a wish, or a robot, that takes more time than there is.
[[nodiscard]] hal::FrameFormat format_for(int joints, double period_s,
                                          std::optional<hal::FrameFormat> wished);

}  // namespace offnominal::tools
