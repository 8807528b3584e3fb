#include "log/candump_text.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace offnominal::desk {

std::string candump_line(const hal::Frame& frame, hal::Microseconds time_us,
                         const std::string& interface) {
  constexpr hal::Microseconds kSecond = 1'000'000;
  std::string line = fmt::format("({}.{:06}) {} ", time_us / kSecond, time_us % kSecond, interface);
  line += frame.extended ? fmt::format("{:08X}", frame.id) : fmt::format("{:03X}", frame.id);
  if (frame.remote) return line + fmt::format("#R{}\n", frame.length);
  line += frame.fd ? "##1" : "#";
  for (std::size_t i = 0; i < frame.length; ++i) line += fmt::format("{:02X}", frame.data[i]);
  return line + "\n";
}

}  // namespace offnominal::desk
