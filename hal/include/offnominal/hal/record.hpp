#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <offnominal/hal/crc.hpp>
#include <offnominal/hal/status.hpp>
#include <span>

namespace offnominal::hal {

// Everything travels in records of 8 bytes: 5 of content, little-endian, a counter, and a CRC over
// those six, most significant byte first. A classic CAN frame carries one record, a CAN FD frame up
// to 8 of them, each protected by itself: one 16-bit CRC keeps its Hamming distance over 64 bits,
// not over 512.
inline constexpr std::size_t kContentLength = 5;
inline constexpr std::size_t kRecordLength = 8;
inline constexpr std::size_t kCounterByte = 5;

using Record = std::array<std::uint8_t, kRecordLength>;
using Content = std::array<std::uint8_t, kContentLength>;

// Counter: one more with every record of the same data id, 255 is followed by 0.
[[nodiscard]] constexpr Record seal(const Content& content, std::uint8_t counter,
                                    std::uint16_t data_id) {
  Record record{};
  std::copy(content.begin(), content.end(), record.begin());
  record[kCounterByte] = counter;
  const std::uint16_t crc = crc16(std::span(record).first<kContentLength + 1>(), data_id);
  record[6] = static_cast<std::uint8_t>(crc >> 8U);
  record[7] = static_cast<std::uint8_t>(crc & 0xFFU);
  return record;
}

// A record's content and counter. kWrongCrc, and both unchanged, where a bit is wrong or the record
// belongs to another data id.
[[nodiscard]] constexpr Status open(std::span<const std::uint8_t, kRecordLength> record,
                                    std::uint16_t data_id, Content& content,
                                    std::uint8_t& counter) {
  const std::uint16_t crc = crc16(record.first<kContentLength + 1>(), data_id);
  if (record[6] != crc >> 8U || record[7] != (crc & 0xFFU)) return Status::kWrongCrc;
  std::copy_n(record.begin(), kContentLength, content.begin());
  counter = record[kCounterByte];
  return Status::kOk;
}

// Unsigned number of the bytes, least significant first; at most 4.
[[nodiscard]] constexpr std::uint32_t from_little_endian(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = (value << 8U) | bytes[i];
  return value;
}

constexpr void to_little_endian(std::uint32_t value, std::span<std::uint8_t> bytes) {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value & 0xFFU);
    value >>= 8U;
  }
}

}  // namespace offnominal::hal
