// Classic CAN where it is wide enough, CAN FD where it is not.
#pragma once

#include <offnominal/hal/drive_description.hpp>
#include <optional>

#include "drives/drive_settings.hpp"

namespace offnominal::desk {

/// Of the options --fd and --classic, of which one at most is given.
[[nodiscard]] inline std::optional<hal::FrameFormat> wished_format(bool fd, bool classic) {
  if (fd) return hal::FrameFormat::kFd;
  return classic ? std::optional(hal::FrameFormat::kClassic) : std::nullopt;
}

/// The wished format, or else the first of classic CAN and CAN FD that leaves room on the bus for
/// what the drives' protocol sends, at hal::BitRates. Throws InputError for a wish, or a robot,
/// that takes more time than there is, and for CAN FD where the protocol has none.
[[nodiscard]] hal::FrameFormat format_for(const DriveSettings& drives, int joints, double period_s,
                                          std::optional<hal::FrameFormat> wished);

/// Throws InputError where the protocol's drives always send velocities.
void require_positions_alone(const DriveSettings& drives);

}  // namespace offnominal::desk
