#pragma once

#include <array>
#include <cstdint>

namespace offnominal::hal {

// Monotonic time of one machine, microseconds from an origin that never moves while a program runs.
using Microseconds = std::int64_t;

inline constexpr std::uint8_t kMaxClassicLength = 8;
inline constexpr std::uint8_t kMaxFdLength = 64;
inline constexpr std::uint32_t kMaxStandardId = 0x7FF;
inline constexpr std::uint32_t kMaxExtendedId = 0x1FFFFFFF;

// A CAN or CAN FD frame. Bytes from `length` on are not part of it.
struct Frame {
  std::uint32_t id = 0;     // 11 bits, or 29 where extended
  bool extended = false;    // 29-bit identifier
  bool fd = false;          // CAN FD, with the bit rate switched for its data
  bool remote = false;      // a request; carries no data
  std::uint8_t length = 0;  // bytes: 0 to 8; CAN FD also 12, 16, 20, 24, 32, 48, 64
  std::array<std::uint8_t, kMaxFdLength> data{};
};

// A frame as it came off the bus. `time_us`: when, by the best clock that the backend has, on the
// time scale of its now().
struct ReceivedFrame {
  Frame frame;
  Microseconds time_us = 0;
};

// Whether a bus can carry the frame: identifier and length in range, no data with a request.
[[nodiscard]] constexpr bool is_well_formed(const Frame& frame) {
  if (frame.id > (frame.extended ? kMaxExtendedId : kMaxStandardId)) return false;
  if (frame.remote) return !frame.fd && frame.length <= kMaxClassicLength;
  if (!frame.fd || frame.length <= kMaxClassicLength) return frame.length <= kMaxClassicLength;
  for (const int length : {12, 16, 20, 24, 32, 48, 64}) {
    if (frame.length == length) return true;
  }
  return false;
}

// Identifiers that agree with `id` in every bit of `mask`, of the one length of identifier.
struct IdFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = kMaxExtendedId;
  bool extended = false;
};

[[nodiscard]] constexpr bool passes(const IdFilter& filter, const Frame& frame) {
  return filter.extended == frame.extended && ((filter.id ^ frame.id) & filter.mask) == 0;
}

}  // namespace offnominal::hal
