#include "exchange/angle_text.hpp"

#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include "common/small_letters.hpp"

namespace offnominal::desk::exchange {
namespace {

// Takes a number without a sign off the front of `text`; none, and nothing taken, where there is
// none.
std::optional<double> take_number(std::string_view& text) {
  if (text.empty() || text.front() == '-') return std::nullopt;
  double value = 0;
  const auto [rest, error] =
      std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  return value;
}

bool take(std::string_view& text, std::string_view begin) {
  if (!text.starts_with(begin)) return false;
  text.remove_prefix(begin.size());
  return true;
}

// Behind a '/'; 1 where there is none.
std::optional<double> take_divisor(std::string_view& text) {
  if (!take(text, "/")) return 1;
  const auto divisor = take_number(text);
  return divisor && *divisor > 0 ? divisor : std::nullopt;
}

}  // namespace

std::optional<double> share_of_pi(std::string_view text) {
  std::string small;
  for (const char c : text) {
    if (c != ' ' && c != '\t') small += in_small_letter(c);
  }
  std::string_view rest = small;
  const double sign = take(rest, "-") ? -1 : 1;
  if (sign > 0) take(rest, "+");
  double share = 1;
  if (const auto factor = take_number(rest)) {
    const auto divisor = take_divisor(rest);
    if (!divisor) return std::nullopt;
    share = *factor / *divisor;
    take(rest, "*");
  }
  if (!take(rest, "pi") && !take(rest, "\u03c0")) return std::nullopt;
  if (take(rest, "*")) {
    const auto factor = take_number(rest);
    if (!factor) return std::nullopt;
    share *= *factor;
  }
  const auto divisor = take_divisor(rest);
  if (!divisor || !rest.empty()) return std::nullopt;
  return sign * share * std::numbers::pi / *divisor;
}

}  // namespace offnominal::desk::exchange
