#include "loop/frame_format.hpp"

#include <fmt/format.h>

#include <array>
#include <offnominal/hal/wire_time.hpp>
#include <span>
#include <string>
#include <vector>

#include "common/error.hpp"

namespace offnominal::tools {
namespace {

constexpr const char* name_of(hal::FrameFormat format) {
  return format == hal::FrameFormat::kClassic ? "classic CAN" : "CAN FD";
}

}  // namespace

double largest_load(int joints, double period_s, hal::FrameFormat format) {
  const std::vector<hal::Record> records(static_cast<std::size_t>(joints));
  std::vector<hal::Frame> frames(records.size());
  double busy_s = 0;
  for (const hal::MessageKind kind : {hal::MessageKind::kEncoder, hal::MessageKind::kDriveStatus,
                                      hal::MessageKind::kTorqueCommand}) {
    const std::size_t count = pack(kind, records, format, frames);
    for (std::size_t i = 0; i < count; ++i) busy_s += hal::longest_wire_time_s(frames[i]);
  }
  return busy_s / period_s;
}

hal::FrameFormat format_for(int joints, double period_s, std::optional<hal::FrameFormat> wished) {
  constexpr double kMostLoad = 0.9;
  const auto classic = hal::FrameFormat::kClassic;
  const bool fits = largest_load(joints, period_s, classic) <= kMostLoad;
  const hal::FrameFormat format = wished.value_or(fits ? classic : hal::FrameFormat::kFd);
  const double load = largest_load(joints, period_s, format);
  // What is wished for may be tight; what does not fit cannot be had.
  if (load <= 1.0) return format;
  throw InputError({"bus", name_of(format),
                    fmt::format("{} joints at {:.0f} ticks a second, {:.0f} % of the bus's time",
                                joints, 1 / period_s, 100 * load),
                    "100 % at most",
                    format == classic ? "give --fd, or frames = \"fd\" in a scenario"
                                      : "fewer ticks: period_s of the robot file, or --rate"});
}

}  // namespace offnominal::tools
