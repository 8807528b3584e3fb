#include "loop/frame_format.hpp"

#include <fmt/format.h>

#include <string>

#include "common/error.hpp"
#include "drives/drive_table.hpp"

namespace offnominal::desk {
namespace {

constexpr const char* name_of(hal::FrameFormat format) {
  return format == hal::FrameFormat::kClassic ? "classic CAN" : "CAN FD";
}

constexpr const char* mend_for(hal::FrameFormat format, bool has_fd) {
  return format == hal::FrameFormat::kClassic && has_fd
             ? "give --fd, or frames = \"fd\" in a scenario"
             : "fewer ticks: period_s of the robot file, or --rate";
}

}  // namespace

hal::FrameFormat format_for(const DriveSettings& drives, int joints, double period_s,
                            std::optional<hal::FrameFormat> wished) {
  constexpr double kMostLoad = 0.9;
  const DriveProtocol& protocol = protocol_of(drives);
  const auto load_of = [&](hal::FrameFormat format) {
    return protocol.busy_share(values_of(drives), static_cast<std::size_t>(joints), format,
                               period_s);
  };
  const auto classic = hal::FrameFormat::kClassic;
  if (wished == hal::FrameFormat::kFd && !protocol.has_fd) {
    throw InputError({"bus", name_of(*wished), std::string("drives that speak ") + protocol.name,
                      name_of(classic), "leave out --fd, or frames = \"fd\" in a scenario"});
  }
  const bool fits = load_of(classic) <= kMostLoad || !protocol.has_fd;
  const hal::FrameFormat format = wished.value_or(fits ? classic : hal::FrameFormat::kFd);
  const double load = load_of(format);
  // What is wished for may be tight; what does not fit cannot be had.
  if (load <= 1.0) return format;
  throw InputError({"bus", name_of(format),
                    fmt::format("{} joints at {:.0f} ticks a second, {:.0f} % of the bus's time",
                                joints, 1 / period_s, 100 * load),
                    "100 % at most", mend_for(format, protocol.has_fd)});
}

void require_positions_alone(const DriveSettings& drives) {
  const DriveProtocol& protocol = protocol_of(drives);
  if (protocol.has_positions_alone) return;
  throw InputError({"drives", "velocity",
                    std::string("observed, of drives that speak ") + protocol.name,
                    "the velocities that they send",
                    "leave out --observe-velocity, or velocity = \"observed\" in a scenario"});
}

}  // namespace offnominal::desk
