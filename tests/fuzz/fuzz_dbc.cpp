// A DBC file that is none: parse_dbc() refuses it with an InputError, or every signal of what comes
// back can be read from a message of its length.

#include <array>
#include <cstdlib>
#include <string_view>

#include "common/error.hpp"
#include "log/dbc.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace offnominal::desk;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const Dbc dbc = parse_dbc(text, "input");
    constexpr std::array<std::uint8_t, 64> kBytes{0xFF, 0x80, 0x01};
    for (const DbcMessage& message : dbc.messages) {
      const auto length = static_cast<std::size_t>(message.length);
      for (const DbcSignal& signal : message.signals) {
        if (length > kBytes.size() || !signal.fits(length)) continue;
        static_cast<void>(signal.value_in(std::span(kBytes).first(length)));
      }
    }
  } catch (const InputError&) {
  }
  return 0;
}
