#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace offnominal::desk {

/// A signal of a DBC file: where it lies in a frame and what its bits mean.
struct DbcSignal {
  std::string name;
  int start_bit = 0;  // as the file has it: of the lowest bit, or with big-endian of the highest
  int length = 0;     // bits
  bool little_endian = true;
  bool is_signed = false;
  bool is_float = false;  // IEEE 754, of 32 or 64 bits
  double scale = 1;
  double offset = 0;
  std::string unit;

  /// scale * bits + offset. The bytes have to hold the signal; fits() says whether they do.
  [[nodiscard]] double value_in(std::span<const std::uint8_t> bytes) const;
  [[nodiscard]] bool fits(std::size_t bytes) const;
  bool operator==(const DbcSignal&) const = default;
};

struct DbcMessage {
  std::uint32_t id = 0;
  bool extended = false;
  std::string name;
  int length = 0;  // bytes
  std::vector<DbcSignal> signals;

  bool operator==(const DbcMessage&) const = default;
};

struct Dbc {
  std::vector<DbcMessage> messages;

  [[nodiscard]] const DbcMessage* find(std::uint32_t id, bool extended) const;
};

/// Messages, signals and which of them are floating-point numbers; whatever else a DBC file holds
/// is passed over, and so are multiplexed signals. Throws InputError with the line for a message or
/// a signal that is not written as it should be, or that does not fit into its message.
[[nodiscard]] Dbc parse_dbc(std::string_view text, const std::string& file);
[[nodiscard]] Dbc read_dbc(const std::filesystem::path& path);

/// hal/offnominal.dbc as it stood when the program was built.
[[nodiscard]] const Dbc& offnominal_dbc();

}  // namespace offnominal::desk
