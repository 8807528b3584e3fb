#include "line_text.hpp"

#include <charconv>
#include <cstdarg>
#include <cstdio>
#include <offnominal/realtime/cycle_timer.hpp>

namespace offnominal::realtime {
namespace {

// Appends to a line; what does not fit is left out, and nothing that is written here is so long.
class Text {
 public:
  explicit Text(std::span<char> into) : into_(into) {}

  [[gnu::format(printf, 2, 3)]] void print(const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    const int written =
        std::vsnprintf(into_.data() + size_, into_.size() - size_, format, arguments);
    va_end(arguments);
    if (written > 0 && static_cast<std::size_t>(written) < into_.size() - size_) {
      size_ += static_cast<std::size_t>(written);
    }
  }
  void number(double value) {
    const auto end = std::to_chars(into_.data() + size_, into_.data() + into_.size(), value);
    if (end.ec == std::errc()) size_ = static_cast<std::size_t>(end.ptr - into_.data());
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::span<char> into_;
  std::size_t size_ = 0;
};

}  // namespace

std::size_t candump_text(const FrameEntry& entry, const char* interface,
                         std::span<char, kLongestLine> into) {
  const hal::Frame& frame = entry.frame;
  Text text(into);
  text.print("(%lld.%06lld) %s ", static_cast<long long>(entry.time_us / kSecond),
             static_cast<long long>(entry.time_us % kSecond), interface);
  text.print(frame.extended ? "%08X" : "%03X", frame.id);
  if (frame.remote) {
    text.print("#R%u\n", frame.length);
    return text.size();
  }
  text.print(frame.fd ? "##1" : "#");
  for (std::size_t i = 0; i < frame.length; ++i) text.print("%02X", frame.data[i]);
  text.print("\n");
  return text.size();
}

std::size_t row_text(const Row& row, std::size_t values, std::span<char, kLongestLine> into) {
  Text text(into);
  text.print("%lld.%06lld", static_cast<long long>(row.time_us / kSecond),
             static_cast<long long>(row.time_us % kSecond));
  for (std::size_t i = 0; i < values; ++i) {
    text.print(",");
    text.number(row.values[i]);
  }
  text.print(",%u\n", row.digit % 10U);
  return text.size();
}

}  // namespace offnominal::realtime
