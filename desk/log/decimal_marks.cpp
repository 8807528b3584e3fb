#include "log/decimal_marks.hpp"

#include <cstddef>

namespace offnominal::desk {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// A mark, and three digits behind it.
bool has_three_decimals(std::string_view text) {
  constexpr std::size_t kDecimals = 3;
  return text.size() > kDecimals + 1 && !is_digit(text[text.size() - kDecimals - 1]);
}

// "1.371", "-12.345.678", and neither "0.371" nor "1.37".
bool may_be_thousands(std::string_view text, char mark) {
  constexpr std::size_t kGroup = 3;
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  const std::size_t first = text.find(mark);
  if (first == std::string_view::npos || first == 0 || first > kGroup || text[0] == '0') {
    return false;
  }
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_mark = i >= first && (i - first) % (kGroup + 1) == 0;
    if (is_mark ? text[i] != mark : !is_digit(text[i])) return false;
  }
  return (text.size() - first) % (kGroup + 1) == 0;
}

}  // namespace

bool DecimalMarks::is_news(std::string_view text) const {
  for (const Mark* const seen : {&points_, &commas_}) {
    if (seen->any && (seen->thousands || !has_three_decimals(text))) continue;
    if (text.find(seen->mark) == std::string_view::npos) continue;
    if (!seen->any || may_be_thousands(text, seen->mark)) return true;
  }
  return false;
}

std::optional<DecimalMarks::Contradiction> DecimalMarks::note(std::string_view text,
                                                              const std::string& column) {
  for (Mark* const seen : {&points_, &commas_}) {
    if (text.find(seen->mark) == std::string_view::npos) continue;
    const bool is_thousands = !seen->thousands && may_be_thousands(text, seen->mark);
    if (seen->any && !is_thousands) continue;
    const std::string words = std::string(text) + " of column " + column;
    if (!seen->any) seen->any = words;
    if (is_thousands) seen->thousands = words;
  }
  if (auto found = between(points_, commas_)) return found;
  return between(commas_, points_);
}

std::optional<DecimalMarks::Contradiction> DecimalMarks::between(const Mark& first,
                                                                 const Mark& second) {
  if (!first.thousands || !second.any) return std::nullopt;
  return Contradiction{*first.thousands, *second.any};
}

}  // namespace offnominal::desk
