#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace offnominal::desk {

// A time of a recording in s, without its unit: six digits, or to a tenth of a millisecond where
// that is more, as of a clock that counts from long ago.
inline std::string words_of_time(double t_s) {
  constexpr double kFewDigits = 100;
  if (std::abs(t_s) < kFewDigits) return fmt::format("{:.6g}", t_s);
  std::string words = fmt::format("{:.4f}", t_s);
  words.erase(words.find_last_not_of('0') + 1);
  if (words.back() == '.') words.pop_back();
  return words;
}

}  // namespace offnominal::desk
