#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace offnominal::desk {

/// "coulomb friction" of "coulomb_friction".
[[nodiscard]] inline std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// As a title begins: "Coulomb friction" of "coulomb friction".
[[nodiscard]] inline std::string capitalised(std::string words) {
  if (!words.empty()) {
    words.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(words.front())));
  }
  return words;
}

}  // namespace offnominal::desk
