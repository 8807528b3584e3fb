#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/record.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

// Which identifier carries which message. A lower identifier wins the bus: a stop before commands,
// commands before what is measured.

namespace offnominal::hal {

enum class MessageKind : std::uint8_t {
  kEmergencyStop = 0,
  kTorqueCommand = 1,
  kEncoder = 2,
  kDriveStatus = 3,
  kHeartbeat = 4,
  kDiagnosis = 5,
  kFault = 6,
};
inline constexpr int kMessageKinds = 7;

inline constexpr int kMaxNodes = 32;           // joints, counted from 0; other nodes likewise
inline constexpr int kMaxRecordsPerFrame = 8;  // CAN FD

// The first node whose record a frame carries, and how many follow.
struct Address {
  MessageKind kind = MessageKind::kEncoder;
  std::uint8_t first_node = 0;
  std::uint8_t count = 1;
};

namespace detail {

// Identifiers of one record each are base + node, those of CAN FD groups group_base + first node.
struct KindIds {
  std::uint32_t base;
  std::uint32_t group_base;  // 0: never in groups
};
inline constexpr std::array<KindIds, kMessageKinds> kKindIds = {{{0x020, 0},
                                                                 {0x100, 0x120},
                                                                 {0x180, 0x1A0},
                                                                 {0x200, 0x220},
                                                                 {0x700, 0},
                                                                 {0x720, 0},
                                                                 {0x740, 0}}};

}  // namespace detail

// The identifier of a classic frame with one record of a node below kMaxNodes.
[[nodiscard]] constexpr std::uint32_t id_of(MessageKind kind, std::uint8_t node) {
  return detail::kKindIds[static_cast<std::size_t>(kind)].base + node;
}

// What seeds the CRC: other for every kind and node, never 0 (of which all-zero bytes are a valid
// record), and far apart in bits, so that no single wrong bit makes one of the other.
[[nodiscard]] constexpr std::uint16_t data_id_of(MessageKind kind, std::uint8_t node) {
  const std::uint32_t number = static_cast<std::uint32_t>(kind) * kMaxNodes + node + 1;
  return static_cast<std::uint16_t>((number * 0x9E37U) & 0xFFFFU);
}

// One record in a classic frame. Bytes of `into` beyond it stay what they are.
constexpr void write_frame(MessageKind kind, std::uint8_t node, const Record& record, Frame& into) {
  into.id = id_of(kind, node);
  into.extended = into.fd = into.remote = false;
  into.length = kRecordLength;
  std::copy(record.begin(), record.end(), into.data.begin());
}
[[nodiscard]] constexpr Frame frame_of(MessageKind kind, std::uint8_t node, const Record& record) {
  Frame frame;
  write_frame(kind, node, record, frame);
  return frame;
}

// Records of consecutive nodes, at most 8, in one CAN FD frame; what a length of CAN FD has too
// much is zero, which is no valid record. kInvalidValue for none, for too many and for a kind that
// has no groups.
[[nodiscard]] constexpr Status group_frame_of(MessageKind kind, std::uint8_t first_node,
                                              std::span<const Record> records, Frame& frame) {
  const std::uint32_t base = detail::kKindIds[static_cast<std::size_t>(kind)].group_base;
  if (base == 0 || records.empty() || records.size() > kMaxRecordsPerFrame) {
    return Status::kInvalidValue;
  }
  if (first_node + records.size() > kMaxNodes) return Status::kInvalidValue;
  constexpr std::array<std::uint8_t, kMaxRecordsPerFrame> kLengths = {8,  16, 24, 32,
                                                                      48, 48, 64, 64};
  frame = Frame{};
  frame.id = base + first_node;
  frame.fd = true;
  frame.length = kLengths[records.size() - 1];
  std::size_t at = 0;
  for (const Record& record : records) {
    for (const std::uint8_t byte : record) frame.data[at++] = byte;
  }
  return Status::kOk;
}

// What a frame says it carries; its records are still to be opened. kNotADataFrame for a request,
// kUnknownId for what is not offnominal's, kWrongFormat for a classic identifier in a CAN FD frame
// and the reverse, kWrongLength. `address` is unchanged then.
[[nodiscard]] constexpr Status address_of(const Frame& frame, Address& address) {
  if (frame.remote) return Status::kNotADataFrame;
  if (frame.extended) return Status::kUnknownId;
  for (std::size_t k = 0; k < kMessageKinds; ++k) {
    const detail::KindIds& ids = detail::kKindIds[k];
    const bool single = frame.id - ids.base < kMaxNodes;
    const bool group = ids.group_base != 0 && frame.id - ids.group_base < kMaxNodes;
    if (!single && !group) continue;
    if (frame.fd != group) return Status::kWrongFormat;
    const std::uint32_t first = frame.id - (group ? ids.group_base : ids.base);
    const std::uint32_t count = frame.length / kRecordLength;
    const bool whole = frame.length % kRecordLength == 0 && is_well_formed(frame) && count >= 1;
    if (!whole || (single && count != 1) || first + count > kMaxNodes) return Status::kWrongLength;
    address = {static_cast<MessageKind>(k), static_cast<std::uint8_t>(first),
               static_cast<std::uint8_t>(count)};
    return Status::kOk;
  }
  return Status::kUnknownId;
}

// Record number `index`, below the address's count, of a frame that address_of() has accepted.
[[nodiscard]] constexpr std::span<const std::uint8_t, kRecordLength> record_in(const Frame& frame,
                                                                               std::size_t index) {
  return std::span<const std::uint8_t, kRecordLength>(
      std::span(frame.data).subspan(index * kRecordLength, kRecordLength));
}

}  // namespace offnominal::hal
