#include "common/amount.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace offnominal::desk {

std::string counted(std::size_t count, const std::string& noun, const std::string& plural) {
  if (count == 1) return "1 " + noun;
  return fmt::format("{} {}", count, plural.empty() ? noun + "s" : plural);
}

std::string significant(double value, int digits) {
  std::string rounded = fmt::format("{:.{}e}", value, digits - 1);
  if (value == 0) return "0";
  const auto mark = rounded.find('e');
  if (mark == std::string::npos) return rounded;
  const int exponent = std::stoi(rounded.substr(mark + 1));
  constexpr int kLeast = -4;
  constexpr int kMost = 6;
  if (exponent < kLeast || exponent >= kMost) return fmt::format("{:.{}g}", value, digits);
  return fmt::format("{:.{}f}", std::stod(rounded), std::max(0, digits - 1 - exponent));
}

}  // namespace offnominal::desk
