#pragma once

#include <string>

namespace offnominal::desk {

/// A to Z as a to z; every other byte, those of UTF-8 too, as it is.
[[nodiscard]] constexpr char in_small_letter(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// The same of a text, letter by letter.
[[nodiscard]] inline std::string in_small_letters(std::string text) {
  for (char& c : text) c = in_small_letter(c);
  return text;
}

}  // namespace offnominal::desk
